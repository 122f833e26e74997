# fibertwin: one command each. `make` alone explains itself.
PYTHON ?= python3
CASE   ?= cases/default.toml
VENV   := .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.ready
COUNT  ?= 200

.DEFAULT_GOAL := help
.PHONY: help setup case test test-slow fuzz coverage check bench verify docs constraints clean

help:  ## Say what there is
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | awk -F ':.*## ' '{printf "  make %-10s %s\n", $$1, $$2}'
	@echo "  CASE=cases/...  which case 'make case' runs (now $(CASE)); PYTHON=... which Python 3.11+ makes the environment"

setup: $(READY)  ## Make the Python environment in .venv

$(READY): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	  || { echo "fibertwin needs Python 3.11 or newer, $(PYTHON) is older; say which with make PYTHON=python3.12"; exit 1; }
	@$(PYTHON) -m venv $(VENV) \
	  || { echo "no virtual environment could be made; on Debian: apt-get install python3-venv"; exit 1; }
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[dev]'
	@echo "compiling the loops of the numerics, once"
	@$(BIN)/fibertwin run smoke --until solve --out build/first --quiet
	@touch $(READY)

case: setup  ## Run a case end to end into runs/<its name>
	$(BIN)/fibertwin run $(CASE)

test: setup  ## Run the tests (those that need OpenFOAM are skipped where it is missing)
	$(BIN)/pytest -n auto --dist loadfile

test-slow: setup  ## Run the tests that take minutes
	$(BIN)/pytest -m slow --timeout 3600

fuzz: setup  ## Draw COUNT inputs for each reader of strangers' files, and kill COUNT runs at random (hours at 2000)
	$(BIN)/python -m tests.security.fuzz $(COUNT)
	$(BIN)/python -m tests.processes.kills $(COUNT)

coverage: setup  ## Which lines the tests run, with the compiled loops run by Python (an hour)
	NUMBA_DISABLE_JIT=1 $(BIN)/pytest -n auto --dist loadfile --timeout 3600 --cov pipeline --cov-report term-missing:skip-covered

check: setup  ## Style, types, imports, and the examples in the documentation
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/deptry pipeline
	$(BIN)/pytest --doctest-modules pipeline docs README.md

bench: setup  ## Measure what docs/meshing.md and docs/formats.md show (half an hour; needs OpenFOAM)
	$(BIN)/python -m benchmarks.meshing runs/bench/meshing
	$(BIN)/python -m benchmarks.growth runs/bench/growth 12.5 25 50 100
	$(BIN)/python -m benchmarks.robustness 10
	$(BIN)/python -m benchmarks.robustness 10 tetwild
	$(BIN)/pytest benchmarks --benchmark-only --benchmark-group-by=func

verify: setup  ## Solve arrays, lattices and mats, and write what docs/verification.md shows (half an hour of processor time; needs OpenFOAM)
	$(BIN)/python docs/verify.py runs/verification

docs: setup  ## Build the site of docs/ into build/site, with the notebook run and the gallery drawn anew
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[docs]'
	$(BIN)/python docs/build.py build/site

constraints:  ## Renew constraints.txt: the newest versions that pip finds, in an environment of their own
	@$(PYTHON) -m venv build/constraints
	build/constraints/bin/python -m pip install --quiet --disable-pip-version-check --upgrade --editable '.[dev,docs]'
	@echo "# The versions that the tests were run with; \`make setup\` installs just these, \`make constraints\` renews them." > constraints.txt
	build/constraints/bin/python -m pip freeze --exclude-editable >> constraints.txt

clean:  ## Remove what can be made again (runs/ is kept)
	rm -rf $(VENV) .pytest_cache .mypy_cache .ruff_cache .hypothesis .benchmarks .import_linter_cache dist build
	find pipeline tests benchmarks -name __pycache__ -type d -prune -exec rm -rf {} +
