"""Tables of a report, in Markdown, HTML, LaTeX and CSV."""
