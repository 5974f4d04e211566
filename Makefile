# waybound: `make demo` and `make test` create the environment where it is missing; everything else is in CONTRIBUTING.md.
# Another Python has an environment of its own: `make test PYTHON=python3.13`. One wing with what every method must keep: `make test WING=risk`.
PYTHON ?= python3
PYTEST_FLAGS ?=
WING ?=
ROOMS := $(if $(WING),$(shell find tests -type d -name $(WING)) tests/conformance)
VERSION := $(if $(filter-out python3,$(PYTHON)),-$(shell $(PYTHON) -c 'import sys; print("%d.%d" % sys.version_info[:2])'))
VENV := .venv$(VERSION)
BIN := $(VENV)/bin
READY := $(VENV)/.ready
EXTRAS := dev
# Tests start hundreds of processes: bytecode is kept for them, whatever the environment says. Of two workers each has one core:
# threads of linear algebra would wait for each other by spinning.
TESTING := PYTHONDONTWRITEBYTECODE= OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 MKL_NUM_THREADS=1

.PHONY: demo test test-all test-hostile coverage lint format docs screenshots benchmarks clean

# python3-venv may be missing (Debian splits it off): then a bare environment, filled by the system's pip.
$(VENV)/.docs-ready: EXTRAS = dev,docs
$(READY) $(VENV)/.docs-ready: pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "waybound needs Python 3.11 or newer; set PYTHON=..." >&2; exit 2; }
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV) >/dev/null 2>&1 || { rm -rf $(VENV); $(PYTHON) -m venv --without-pip $(VENV); }
	@if $(BIN)/python -m pip --version >/dev/null 2>&1; \
	then $(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[$(EXTRAS)]'; \
	else $(PYTHON) -m pip --python $(BIN)/python install --quiet --disable-pip-version-check --editable '.[$(EXTRAS)]'; fi
	@touch $@ $(READY)

demo: $(READY)
	@mkdir -p demo
	$(BIN)/waybound solve demo-c25 --solver highs --convention trunc1 --time-limit 60 --bound-time 10 --plot demo/demo-c25.png --certificate demo/demo-c25.certificate.json --out demo/demo-c25.json
	$(BIN)/waybound check demo-c25 demo/demo-c25.json --certificate demo/demo-c25.certificate.json --convention trunc1
	@echo "The map is in demo/demo-c25.png"

test: $(READY)
	$(TESTING) $(BIN)/python -m pytest -n 2 --dist worksteal -q -rs $(ROOMS) $(PYTEST_FLAGS)

test-all: $(READY)
	WAYBOUND_DRAWS=all $(TESTING) $(BIN)/python -m pytest -n 2 --dist worksteal -q -rs -m "not hostile" $(PYTEST_FLAGS)

test-hostile: $(READY)
	WAYBOUND_HOSTILE=1 $(TESTING) $(BIN)/python -m pytest tests/hostile -n 2 --dist worksteal -q -rs -m "hostile or not hostile" $(PYTEST_FLAGS)

# Tracing takes a minute more; fewer than 90 % are an error.
coverage: $(READY)
	$(TESTING) $(BIN)/python -m pytest -n 2 --dist worksteal -q --cov --cov-report=term:skip-covered $(PYTEST_FLAGS)

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: $(READY)
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

# The site, with all notebooks executed (some minutes); warnings are errors. The variable silences an advertisement.
docs: $(VENV)/.docs-ready
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --quiet
	@echo "The site is in site/index.html"

# Pictures of the site on a desk and on a phone, light and dark; needs Chromium.
screenshots: docs
	$(BIN)/python docs/building/screenshots.py site screenshots

benchmarks: $(READY)
	$(BIN)/python -m waybound.reports.benchmarks.equal_answers --instances 300
	for name in compile_three_index startup overhead greedy certified_ratio local_algorithm compile_max_min saddle protections risk_allocation uncertain_path assignment; do $(BIN)/python -m waybound.reports.benchmarks.$$name || exit 1; done

clean:
	rm -rf .venv .venv-* build dist demo site screenshots .mypy_cache .pytest_cache .ruff_cache .hypothesis .coverage htmlcov *.egg-info
