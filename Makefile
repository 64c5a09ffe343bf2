# Bare `make` lists the targets. Each sets up what it needs, once: a virtual environment in .venv, the Python packages,
# node (the machine's, else one from PyPI) and the page. It needs Python 3.11 or newer, make and the package registries.

PYTHON ?= python3
DRIVE ?=
MODEL ?=
PYTEST_ARGS ?=
EXTRAS ?= dev
BENCH_PEERS := trackers==2.6.1 supervision==0.29.1 norfair==2.3.0

VENV := .venv
BIN := $(VENV)/bin
READY := .make/python
PAGE := $(BIN)/python frontend/hatch_build.py

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help demo test lint bench openapi frontend

help: ## list the targets
	@echo "Usage: make TARGET"
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "  %-10s%s\n", $$1, $$2 }' $(MAKEFILE_LIST)

demo: $(READY) ## label a drive and open it for review: make demo [DRIVE=folder] [MODEL=name or file]
	@$(PAGE) build
	@$(BIN)/hindsight demo $(if $(DRIVE),"$(DRIVE)") $(if $(MODEL),--model "$(MODEL)")

test: $(READY) ## run all tests: Python, the page, and the browser where Chromium is found
	@$(PAGE) build
	$(BIN)/pytest -q -n auto $(PYTEST_ARGS)
	$(PAGE) npm test

lint: $(READY) ## check style, types, layers and lock files
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/lint-imports
	PYRIGHT_PYTHON_IGNORE_WARNINGS=1 $(BIN)/pyright --pythonpath $(BIN)/python
	$(PAGE) npm run lint
	@if grep -nE '"resolved": *"[a-z+]+:' frontend/package-lock.json; then \
	  echo "frontend/package-lock.json holds download addresses; make it again with frontend/.npmrc in place" >&2; exit 1; \
	fi

bench: $(READY) ## time our trackers beside others, and with a drive the pipeline: make bench [DRIVE=folder] [MODEL=name or file]
	@HINDSIGHT_SKIP_FRONTEND=1 $(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[bench]'
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps $(BENCH_PEERS)
	@$(BIN)/hindsight benchmark trackers
	@if [ -n "$(DRIVE)" ]; then \
	  $(BIN)/hindsight benchmark pipeline "$(DRIVE)" $(if $(MODEL),--model "$(MODEL)"); \
	fi

openapi: $(READY) ## write frontend/openapi.json and the page's typed client again
	$(BIN)/hindsight openapi .make/openapi.json
	mv .make/openapi.json frontend/openapi.json
	$(PAGE) npm run generate

frontend: $(READY) ## build the page into app/static, if its sources changed
	@$(PAGE) build

$(VENV)/pyvenv.cfg:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	  echo "Hindsight needs Python 3.11 or newer, and '$(PYTHON)' is not; name another: make PYTHON=python3.12 $(MAKECMDGOALS)" >&2; \
	  exit 1; \
	}
	@echo "Creating a virtual environment in $(VENV)"
	@$(PYTHON) -m venv $(VENV) || { \
	  rm -rf $(VENV); \
	  echo "'$(PYTHON) -m venv' failed; on Debian and Ubuntu: apt-get install python3-venv" >&2; \
	  exit 1; \
	}

$(READY): $(VENV)/pyvenv.cfg pyproject.toml
	@echo "Installing the Python packages (the first time takes a few minutes)"
	@HINDSIGHT_SKIP_FRONTEND=1 $(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[$(EXTRAS)]'
	@mkdir -p .make && touch $(READY)
