# `make demo` plans on a shipped map, `make test` runs the tests; each sets up what it needs in .venv first.
PYTHON ?= python3
BIN := .venv/bin
LOWEST := .venv-lowest

.PHONY: help demo test test-lowest lint docs clean
.DEFAULT_GOAL := help

help:
	@echo "make demo         plan on a shipped map and say which figures to open"
	@echo "make test         run the tests"
	@echo "make test-lowest  run the tests with the lowest versions of all requirements, in an environment of its own"
	@echo "make lint         run ruff and pyright"
	@echo "make docs         build the documentation into docs/_build/html"
	@echo "make clean        remove the virtual environments and what was built"

demo: .setup-base
	$(BIN)/pymoo-gridpath plan --output gridpath-out
	@echo "Open gridpath-out/map.png (the map with the chosen paths) and gridpath-out/front.png (the trade-off)."

test: .setup-test
	$(BIN)/python -m pytest

test-lowest: .setup-lowest
	$(LOWEST)/bin/python -m pytest

lint: .setup-test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright

docs: .setup-docs
	$(BIN)/python -m sphinx -W --keep-going -j auto -b html docs docs/_build/html

.venv/pyvenv.cfg:
	@$(PYTHON) -c 'import sys; sys.exit("pymoo_gridpath needs Python 3.11 or newer") if sys.version_info < (3, 11) else None'
	@echo "setting up a virtual environment in .venv"
	@$(PYTHON) -m venv .venv

# Stamps: made again whenever the dependencies change.
.setup-base: pyproject.toml .venv/pyvenv.cfg
	@echo "installing what is needed"
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[fast]'
	@touch $@

.setup-test: pyproject.toml .venv/pyvenv.cfg
	@echo "installing what is needed"
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[test]'
	@touch $@ .setup-base

.setup-docs: pyproject.toml .venv/pyvenv.cfg
	@echo "installing what is needed"
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[docs]'
	@touch $@ .setup-base

# In a new environment each time, so that nothing newer is left in it.
.setup-lowest: pyproject.toml .ci/lowest.py
	@echo "installing the lowest versions of what is needed in $(LOWEST)"
	@$(PYTHON) -m venv --clear $(LOWEST)
	@$(PYTHON) .ci/lowest.py > $(LOWEST)/pins.txt
	@$(LOWEST)/bin/python -m pip install --quiet --disable-pip-version-check --constraint $(LOWEST)/pins.txt --editable '.[test]'
	@touch $@

clean:
	rm -rf .venv $(LOWEST) .setup-* build dist *.egg-info docs/_build docs/api/generated gridpath-out .pytest_cache .ruff_cache .hypothesis
