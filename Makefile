# `make run` and `make test` do all the set-up: a virtual environment in .venv, nothing outside this folder.
PYTHON ?= python3
BIN := .venv/bin
READY := .venv/.ready

# What is compiled, where there is a C compiler, is listed in fraese/compiled.py. Whoever changes one of those sources
# sees the change: all are plain then, until they are compiled anew.
.PHONY: run compiled test test-plain fuzz monkey mutate campaign looks tour engravings pictures coverage check format clean firmware images manual site \
	rig-avr rig-lpt senders

run: $(READY)
	$(BIN)/fraese

# Most tests wait now and then: one more at once than there are cores. What runs in real time comes last, alone but for
# one other of its kind.
WORKERS := $(shell echo $$(($$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1) + 1)))
test: $(READY)
	$(BIN)/pytest -n $(WORKERS) --dist worksteal -m "not alone"
	$(BIN)/pytest -n 2 --dist worksteal -m alone

# What is listed there, compiled, unless it is; fails if it cannot be.
compiled: $(READY)
	@FRAESE_LANGUAGE=en $(BIN)/fraese --version | grep -q ', compiled$$' || $(BIN)/python setup.py --quiet build_ext --inplace
	@FRAESE_LANGUAGE=en $(BIN)/fraese --version | grep ', compiled$$'

# What touches compiled modules, in their plain form. The clock is the only thing that sees the difference elsewhere.
test-plain: $(READY)
	FRAESE_PLAIN=1 $(BIN)/pytest -n auto --dist worksteal -m "not alone" $(COMPILED_TESTS)

COMPILED_TESTS := tests/motor tests/planner tests/gcode tests/contracts tests/program tests/bridge

# Faults in important lines, one at a time: which of them no test sees. ONLY=word: those with it in
# their names. Takes most of an hour.
mutate: $(READY)
	FRAESE_PLAIN=1 $(BIN)/python -m bench.mutants $(ONLY)

# Faults at random moments, hundreds of each kind, and what was claimed against the truth. ONLY="words": kinds with
# all of them in their names. TRIES=10: so many of each; SHORT=1: a few. JOBS=2: attempts at once. ROUND=20: so many
# of each kind in turn. Takes hours; broken off with Ctrl+C it says what it has seen.
campaign: $(READY)
	$(BIN)/python -m bench.campaign $(ONLY) --tries $(or $(TRIES),0) --jobs $(or $(JOBS),1) \
		--round $(or $(ROUND),0) $(if $(SHORT),--short)

# Whatever comes in: FUZZ times as many examples as in the tests, and new ones. ONLY=word: those with
# it in their names.
FUZZ ?= 50
fuzz: $(READY)
	FRAESE_FUZZ=$(FUZZ) $(BIN)/pytest -n auto --dist worksteal tests/fuzz \
		tests/ui/test_bad_terminals.py::test_the_app_lives_whatever_is_typed $(if $(ONLY),-k $(ONLY))

# A monkey at the app: so many keys, clicks, pastes and sizes at random; says seed and last events where something must
# not be. SEED=7: those of this seed; LIFE=3: only that start of the app. Takes most of an hour.
EVENTS ?= 100000
monkey: $(READY)
	$(BIN)/python -m tests.ui.monkey --events $(EVENTS) $(if $(SEED),--seed $(SEED)) $(if $(LIFE),--life $(LIFE))

# How the app looks, written anew: the snapshots of the tests; git shows what has changed.
looks: $(READY)
	FRAESE_LOOKS=1 $(BIN)/pytest -n auto tests/ui/test_looks.py

# The pictures of docs/app.md and docs/app.de.md. LOCALE=de: those of one language.
tour: $(READY)
	$(BIN)/python -m bench.tour $(LOCALE)

# The pictures of docs/engrave.md: its examples, carried out.
engravings: $(READY)
	$(BIN)/python -m bench.engravings

# All pictures of the documentation but those of docs/timing.md, which want a computer for themselves.
pictures: $(READY) tour engravings
	$(BIN)/python -m bench.plots
	$(BIN)/python -m bench.waveform

# Twice as slow.
coverage: $(READY)
	FRAESE_PLAIN=1 $(BIN)/pytest --cov --cov-report=term

check: $(READY)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python -m rigs.audit

format: $(READY)
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

# The image for the ATmega328P; needs gcc-avr, binutils-avr and avr-libc.
firmware:
	$(if $(wildcard firmware/Makefile),$(MAKE) -C firmware,@echo "there is no firmware/ here")

# The images that are installed with the program, built anew; likewise.
images: $(READY)
	$(BIN)/python -m rigs.images

# Man page and completion for shells, as the program is.
manual: $(READY)
	$(BIN)/python -m rigs.manual

# The documentation as a site, in build/site; a link that leads nowhere is an error.
site: .venv/.site-ready
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

.venv/.site-ready: $(READY)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[docs]'
	@touch $@

# The simulated ATmega328P, into .rig-cache/; the tests build it by themselves.
rig-avr: $(READY)
	$(BIN)/python -m rigs.avr.build
# Real senders drive the simulated mill by `fraese serve`: see rigs/senders/README.md. ONLY=name: one of them. In a virtual
# environment of their own; needs npm, and xvfb and python3-tk for bCNC. Takes some minutes.
SENDERS := .rig-cache/senders
senders: $(READY) $(SENDERS)/.ready
	$(SENDERS)/bin/python -m rigs.senders $(ONLY)

$(SENDERS)/.ready: pyproject.toml
	$(PYTHON) -m venv $(SENDERS)
	$(SENDERS)/bin/python -m pip install --quiet --disable-pip-version-check --editable '.[senders]'
	npm install --silent --no-audit --no-fund --prefix $(SENDERS) cncjs@1
	@touch $@

# The ports on a real kernel: QEMU, Debian's kernel, an emulated LPT. See rigs/lpt/README.md.
rig-lpt: $(READY)
	$(BIN)/python -m rigs.lpt

$(READY): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "fraese needs Python 3.11 or newer; $(PYTHON) is " + sys.version.split()[0] + ". Name another: make PYTHON=python3.12 run")'
	$(PYTHON) -m venv .venv
	FRAESE_PLAIN=1 $(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	-@$(BIN)/python setup.py --quiet build_ext --inplace
	@touch $@

clean:
	find fraese -name '*.so' -delete
	rm -rf .venv .rig-cache build fraese/compiled.stamp *.egg-info .coverage .mypy_cache .pytest_cache .ruff_cache .import_linter_cache .hypothesis
