"""What was tried of mapping's planner and did not pay by itself: kinds of platforms, one idea each.

`bench.ablation` exchanges them for the default's; what each brought is in the reports.
"""
