"""The experiments of Ahmed and Deb (2013), one module a section; `benchmarks/paper.py` runs them."""
