# Needs Python >= 3.11, Rust >= 1.85, a C linker and GNU make; `make help` lists the targets.
#   make explore ARGS="--robots 5 --seed 7"     options for the command
#   make explore PYTHON=/path/to/python3.12     another Python than the one on PATH
#   make missions MAPS=/path/to/maps            a folder of maps besides the generated offices

VENV := .venv
MAPS ?= ../shared/maps
DIST ?= dist
BIN := $(VENV)/bin
PY := $(BIN)/python
PIP := $(PY) -m pip --disable-pip-version-check --quiet
CARGO_FLAGS := --manifest-path rust/Cargo.toml --target-dir rust/target
ROS2_VENV := .venv-ros2
ROS2 ?= smoke
KERNELS := src/vedette/_kernels.abi3.so
RUST := rust/Cargo.toml rust/Cargo.lock $(shell find rust/src -name '*.rs')

# What is done is remembered by stamps inside the environment, so removing it forgets them too.
PACKAGES := $(VENV)/.packages
DEV_PACKAGES := $(VENV)/.dev-packages
INSTALLED := $(VENV)/.installed

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help explore test test-all test-ros2 check lint types contracts rust-lint bench fuzz mutants blunt missions figures theatre schemas docs dist build ready ready-dev clean

help: ## List the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "make %-10s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

explore: ready ## Watch three robots map an office; the first run also installs everything into .venv
	@$(BIN)/vedette explore $(ARGS)

test: ready-dev ## Run the quick tests
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(PY) -m pytest -m "not slow" -n auto --maxprocesses 4 --dist loadfile $(ARGS)

test-all: ready-dev ## Run all tests, the slow ones too
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(PY) -m pytest -n auto --maxprocesses 4 --dist loadfile $(ARGS)
	@$(MAKE) --no-print-directory test-ros2 ROS2=all

test-ros2: ready-dev ## Run the tests with real rclpy in an environment of its own; ROS2=all: the slow ones too
	@for distribution in kilted$(if $(filter all,$(ROS2)), jazzy); do \
		tools/ros2/environment.sh $$distribution $(ROS2_VENV)-$$distribution $(VENV) build/ros2-$$distribution \
			|| { [ $$? = 3 ] && exit 0; exit 1; }; \
	done; \
	JAZZY="$(if $(filter all,$(ROS2)),$(CURDIR)/$(ROS2_VENV)-jazzy)" \
		tools/ros2/test.sh $(ROS2_VENV)-kilted $(if $(filter all,$(ROS2)),,-m "not slow") $(ARGS)

check: lint types contracts rust-lint ## Do all that .ci/run does: lint, types, import contracts, quick tests
	@$(MAKE) --no-print-directory test

lint: ready-dev ## Lint and check the formatting of the Python code
	@$(BIN)/ruff check
	@$(BIN)/ruff format --check

types: ready-dev ## Check the types
	@$(BIN)/mypy

contracts: ready-dev ## Check that imports run one way
	@$(BIN)/lint-imports --no-logo

rust-lint: ready-dev ## Lint and check the formatting of the Rust code
	@cargo fmt --manifest-path rust/Cargo.toml --check
	@cargo clippy $(CARGO_FLAGS) --quiet --all-targets -- -D warnings

bench: ready-dev ## Measure speed and traffic against the targets: MET or MISSED
	@$(PY) -m bench $(ARGS)

fuzz: ready-dev ## Fuzz every decoder and loader, guided by coverage
	@$(PIP) install -c constraints.txt 'atheris>=3,<4'
	@$(PY) -m tests.fuzz $(ARGS)

mutants: ready-dev ## Put small faults into a copy of the code, for half an hour, and tell which no test notices
	@test -x build/cargo-mutants/bin/cargo-mutants || cargo install --quiet --locked --version 27.1.0 --root build/cargo-mutants cargo-mutants
	@nice -n 19 $(PY) -m tests.mutants $(ARGS)

blunt: ready-dev ## Run the quick tests and tell what in them nothing could have failed
	@PYTHONPYCACHEPREFIX=build/blunt PATH="$(CURDIR)/$(BIN):$$PATH" $(PY) -m pytest -p tests.support.blunt -o enable_assertion_pass_hook=true -m "not slow" $(ARGS)

missions: ready-dev ## Run the table of missions beside the yardsticks (long)
	@$(PY) -m bench.missions $(if $(wildcard $(MAPS)),--maps $(MAPS)) $(ARGS)

figures: ready-dev ## Run the missions that the documents quote; record their figures and pictures
	@$(PY) -m bench.figures $(if $(wildcard $(MAPS)),--maps $(MAPS)) $(ARGS)

theatre: ready-dev ## Play what may befall a team, and write the page that shows it into docs; ARGS=--kept: the page alone
	@PYTHONPATH=. $(PY) tools/theatre.py docs/theatre.html $(ARGS)

schemas: ready-dev ## Write the schema of every JSON that is written into docs/schemas
	@PYTHONPATH=. $(PY) tools/schemas.py docs/schemas

docs: ready-dev ## Build the documentation site, API reference included, into build/docs
	@$(PY) tools/site/build.py build/docs
	@echo "open build/docs/index.html"

dist: ready-dev ## Build the sdist, and wheels for x86-64 and aarch64, into dist/
	@$(PIP) install -c constraints.txt 'ziglang>=0.17,<0.18'
	@PATH="$(CURDIR)/$(BIN):$$PATH" tools/dist.sh $(DIST)

# The copy is moved into place: overwriting a module that a running process has loaded would crash it.
build: ## Compile the kernels and put them in place
	@cargo build --release --quiet $(CARGO_FLAGS) --features extension-module
	@cp rust/target/release/lib_kernels.so $(KERNELS).new && mv $(KERNELS).new $(KERNELS)

clean: ## Remove all that make has made; runs/ stays
	rm -rf $(VENV) $(ROS2_VENV)-* build dist rust/target $(KERNELS) .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache

# Installing compiles the kernels, so make has to look at their age afresh after it.
ready: $(INSTALLED)
	@$(MAKE) --no-print-directory --silent $(KERNELS)

ready-dev: $(DEV_PACKAGES) ready

$(KERNELS): $(RUST)
	@echo "building the kernels"
	@$(MAKE) --no-print-directory build

$(PACKAGES): pyproject.toml reproduction/pyproject.toml constraints.txt
	@python=$$(tools/preflight.sh) || exit 1; \
	if ! $(PIP) --version >/dev/null 2>&1; then \
		echo "making .venv" && "$$python" -m venv $(VENV); \
	fi
	@echo "installing packages"
	@$(PY) tools/requirements.py > $@.txt
	@$(PIP) install -c constraints.txt -r $@.txt
	@touch $@

$(DEV_PACKAGES): $(PACKAGES)
	@echo "installing the developers' packages"
	@$(PY) tools/requirements.py dev > $@.txt
	@$(PIP) install -c constraints.txt -r $@.txt
	@touch $@

# The packages are there already, so pip has only to compile, with the tools that constraints.txt names.
$(INSTALLED): $(PACKAGES)
	@echo "building the kernels"
	@rm -f $(KERNELS)
	@PATH="$(CURDIR)/$(BIN):$$PATH" $(PIP) install --no-deps --no-build-isolation -e . -e ./reproduction
	@touch $@
