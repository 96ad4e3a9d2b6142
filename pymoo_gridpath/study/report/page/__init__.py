"""What stands in a report, and its page and text."""
