# `make reproduce` rebuilds every result, the paper and the report; `make test` tests.
# Both first create .venv and install the locked packages; `make help` names the others.

VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
# A set-up notes its folder: in a copy of it, or after a move, it is made anew
ELSEWHERE := $(shell [ "$$(cat $(READY) 2>/dev/null)" = "$$(pwd -P)" ] || echo elsewhere)
CANDIDATES := python3 python3.14 python3.13 python3.12 python3.11
NEW_ENOUGH := import sys; sys.exit(sys.version_info < (3, 11))
PYTHON ?= $(shell for p in $(CANDIDATES); do \
	"$$p" -c "$(NEW_ENOUGH)" 2>/dev/null && { echo "$$p"; break; }; done)

# What the stepping loops need: they are compiled while the other packages are installed
FIRST := numpy|scipy|llvmlite|numba|platformdirs|threadpoolctl

# Bytecode is written even where the environment forbids it: else every process compiles what it
# imports, for some seconds
export PYTHONDONTWRITEBYTECODE :=

# What a rebuild imports: here once, or else by all of its processes at the same time
IMPORTED := import papermill, ipykernel.kernelapp, ipykernel.zmqshell, pandas.io.formats.style, \
	snakemake.cli, study.claims.table2, study.mechanism, study.pages.report

PYTEST := $(BIN)/python -m pytest --numprocesses auto --dist loadfile --no-loadscope-reorder

# uv where it is found and reaches the packages, else pip; of its packages every 20th is announced
define install
{ uv pip install --quiet --python $(BIN)/python --no-deps $(1) 2>/dev/null || { \
	$(BIN)/python -m pip install --disable-pip-version-check --no-compile --no-deps $(1) || \
	echo FAILED; } | awk '/^FAILED/ { exit 1 } \
		/^(Collecting|Processing|Requirement)/ && ++n % 20 == 0 { \
			print "    " n " packages are here"; fflush() } \
		/^Installing/ { print "    installing them"; fflush() }'; }
endef

UNREACHABLE := echo "Missing: packages of requirements.lock. Is the package index reachable?" >&2; \
	exit 1

.PHONY: help reproduce test test-all check setup lab data bench speed lock clean
.PHONY: elsewhere

help:
	@echo "make reproduce   set up, rebuild what is outdated in build/: results, paper.pdf, report/"
	@echo "make test        set up, run the tests but for the slow ones: copies, reports, loads off the axis"
	@echo "make test-all    set up, run all tests"
	@echo "make check       set up, check style, types and which package imports which"
	@echo "make setup       set up only: .venv with the packages of requirements.lock"
	@echo "make lab         set up, open the notebooks in JupyterLab"
	@echo "make data        set up, solve all cases of the dataset again (some minutes on two cores)"
	@echo "make bench       set up, measure the speed of solver, steppers and studies"
	@echo "make speed       set up, time the charts of speed, also of other programs found here"
	@echo "make lock        renew requirements.lock (needs uv)"
	@echo "make clean       remove .venv, build/ and all caches"

setup: $(READY)
	@echo "Ready: $(BIN)/study --help"

reproduce: $(READY)
	@$(BIN)/study run

test: $(READY)
	@$(PYTEST)

test-all: $(READY)
	@$(PYTEST) -m ""

check: $(READY)
	@$(BIN)/ruff check --no-cache .
	@$(BIN)/ruff format --check --no-cache .
	@$(BIN)/mypy --cache-dir build/mypy
	@$(BIN)/lint-imports --no-cache

lab: $(READY)
	@cd notebooks && ../$(BIN)/jupyter lab

data: $(READY)
	@$(BIN)/study data build --all

bench: $(READY)
	@$(BIN)/python -m pytest tests/bench_*.py --benchmark-columns=median,iqr,rounds

speed: $(READY)
	@PYTHONPATH=tests $(BIN)/python -m benchmarks

lock:
	@uv pip compile --quiet --universal --python-version 3.11 --extra dask --extra test --upgrade \
		--generate-hashes --no-emit-index-url --no-annotate \
		--custom-compile-command "make lock" pyproject.toml --output-file requirements.lock

clean:
	@rm -rf $(VENV) build .snakemake .hypothesis .benchmarks .ruff_cache
	@find . -name __pycache__ -prune -exec rm -rf {} +

requirements.lock:
	@echo "Missing: requirements.lock. Restore it with: git checkout -- requirements.lock" >&2; exit 1

$(READY): requirements.lock pyproject.toml $(ELSEWHERE)
	@"$(PYTHON)" -c "$(NEW_ENOUGH)" 2>/dev/null || { \
		echo "Missing: Python >= 3.11. Install it, or name it: make PYTHON=/path/to/python" >&2; \
		exit 1; }
	@"$(PYTHON)" -c "import ensurepip, venv" 2>/dev/null || { \
		echo "Missing: Python's venv module (on Debian and Ubuntu: python3-venv)" >&2; exit 1; }
	@echo "Setting up (one to three minutes, most of it downloads)"
	@echo "1 of 4: creating $(VENV)"
	@"$(PYTHON)" -m venv --clear $(VENV)
	@echo "2 of 4: installing $$(grep -c == requirements.lock) packages of requirements.lock"
	@awk '/^[^ #]/ { keep = /^($(FIRST))==/ } keep' requirements.lock > $(VENV)/first.lock
	@$(call install,--require-hashes --requirement $(VENV)/first.lock) || { $(UNREACHABLE); }; \
	{ $(BIN)/python -m study.mechanism > $(VENV)/compiled.log & compiling=$$!; } && \
	trap 'kill $$compiling 2>/dev/null' EXIT && trap 'exit 1' INT TERM HUP && \
	{ $(call install,--require-hashes --requirement requirements.lock) || { $(UNREACHABLE); }; } && \
	echo "3 of 4: installing this project" && \
	$(call install,--no-index --no-build-isolation --editable .) && \
	$(BIN)/python -c "$(IMPORTED)" && \
	echo "4 of 4: compiling the time integration loops (begun in step 2)" && \
	{ wait $$compiling || { cat $(VENV)/compiled.log >&2; exit 1; }; } && cat $(VENV)/compiled.log
	@pwd -P > $@
