# Everything happens in a virtual environment of its own, .venv, made on first use.
PYTHON ?= python3
BIN := .venv/bin
# one thread for BLAS: the factorization of a narrow band gains nothing from more
export OMP_NUM_THREADS := 1

.PHONY: strip test coverage lint long docs paper benchmark clean

strip: .venv/run  ## run the shipped strip to its figures, in out/strip
	$(BIN)/isopeel run strip

test: .venv/develop  ## run the tests in as many processes as there are cores
	$(BIN)/python -m pytest -n auto --dist worksteal -rs

coverage: .venv/develop  ## run the same tests, and print the lines of the package that none of them executes
	$(BIN)/python -m pytest -n auto --dist worksteal -rs --cov=isopeel --cov-report=term-missing:skip-covered

lint: .venv/develop  ## check style and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

long: .venv/develop  ## run the tests that take minutes
	$(BIN)/python -m pytest -m long

docs: .venv/develop  ## build the site, in out/docs/html; each page with code as a notebook, in out/docs/jupyter_execute
	$(BIN)/python -m sphinx -q -W --keep-going -b html docs out/docs/html

paper: .venv/run  ## run the published study and write its report, in out/paper
	$(BIN)/isopeel paper

benchmark: .venv/develop  ## time isopeel and other libraries in turn
	$(BIN)/python benchmarks/load_step.py

clean:
	rm -rf .venv out

.venv/run: pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "isopeel needs Python 3.11 or newer, this is " + sys.version)'
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	touch $@

.venv/develop: .venv/run
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev,docs,benchmark]'
	touch $@
