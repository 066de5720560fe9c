# The commands of the project. Each sets up what it needs; once set up, in seconds.

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin

.PHONY: demo test test-slow test-all lint bench mutate docs browser clean

demo: $(VENV)/.ready ## one run with the defaults, recorded
	$(BIN)/fleet run --rrd out/demo.rrd

test: $(VENV)/.ready-dev ## the fast tests
	$(BIN)/python -m pytest -n auto --dist worksteal

test-slow: $(VENV)/.ready-dev browser ## the slow tests: viewers, kills, studies, long runs
	$(BIN)/python -m pytest -n auto --dist worksteal -m slow

test-all: test test-slow ## all tests

lint: $(VENV)/.ready-dev ## style, types, import contracts
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: $(VENV)/.ready-dev ## the measured figures, as ratios within one run
	$(BIN)/python benchmarks/run.py

mutate: $(VENV)/.ready-dev ## small changes that a test is to notice; PACKAGE=protocols.auctions for a part
	$(BIN)/python -m mutmut run $(if $(PACKAGE),'$(PACKAGE).*')
	$(BIN)/python -m mutmut results

docs: $(VENV)/.ready-dev ## the documentation's pages, in out/docs/index.html
	$(BIN)/python -m sphinx -W --keep-going -q -b html docs out/docs

browser: # the web viewer is tested in Debian's chromium; installed here if that is allowed
	@command -v chromium >/dev/null || \
	  { [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null && apt-get update -qq && \
	    apt-get install -qqy chromium mesa-vulkan-drivers libvulkan1 ffmpeg; } || \
	  echo "There is no chromium: the tests that need one are skipped. On Debian: apt-get install chromium mesa-vulkan-drivers libvulkan1 ffmpeg"

$(VENV)/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "Python 3.11 or newer is needed; $(PYTHON) is $$($(PYTHON) -V 2>&1). Try: make PYTHON=python3.12 $(MAKECMDGOALS)"; exit 1; }
	$(PYTHON) -m venv $(VENV)

$(VENV)/.ready: $(VENV)/bin/python pyproject.toml constraints.txt
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e .
	@touch $@

$(VENV)/.ready-dev: $(VENV)/bin/python pyproject.toml constraints.txt
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[dev]'
	@touch $@ $(VENV)/.ready

clean: ## forget everything that was made
	rm -rf $(VENV) out mutants build dist .pytest_cache .mypy_cache .ruff_cache .hypothesis
