"""The operator's window: one page in a browser that shows a mission, live or recorded, and takes orders."""
