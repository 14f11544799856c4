"""The figures and pictures of the documents: recorded by a command, compared with the text by a test."""
