# SPDX-FileCopyrightText: 2026 The Radiosity Bake authors
# SPDX-License-Identifier: GPL-3.0-or-later

PYTHON ?= python3
MAIN := .venv/main/bin/python

.DEFAULT_GOAL := help
.PHONY: help venv zip demo web test test-core test-blender nightly bench parity stability compare lint format clean

help: ## Say what can be made
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' $(MAKEFILE_LIST) | expand -t 15

venv: ## Blender as a Python module, oldest and newest, with all that the tests need, in .venv
	@$(PYTHON) -m tools.environments

zip: venv ## The extension, one zip a platform, in dist
	@$(MAIN) -m tools.build

demo: zip ## Bake the example rooms with the built zip and put the pictures beside path-traced ones, in out/demo
	@$(MAIN) -m tools.demo $(ROOMS)

test: venv ## Everything: formatting, lint, types, all tests, the zip in real Blender and its window
	@$(MAIN) -m tools.run_tests

test-core: venv ## The tests of the numerics, without Blender
	@$(MAIN) -m tools.run_tests core

# make test-blender BLENDER=/opt/blender-4.5/blender, or BLENDER=tools/real_blender.py for Debian's
test-blender: venv ## The Blender side's tests, in the bpy modules or in BLENDER=PATH
ifdef BLENDER
	@$(MAIN) -m tools.test_blender $(BLENDER)
else
	@$(MAIN) -m tools.run_tests "blender py"
endif

# make nightly NIGHTLY="--minutes 480"
nightly: venv ## Try thousands of random ugly scenes that the tests have not tried
	@$(MAIN) -m tools.nightly $(NIGHTLY)

WEB ?= out/demo/cornell_box_baked.blend

web: venv ## Show a baked .blend or a .glb in a web page and keep a browser's picture of it, in out/web
	@$(MAIN) -m tools.web $(WEB)

# make bench BENCH="--scene statue --answers fresh" measures one scene, and the other programs again; --help tells more.
bench: ## Compare with other programs: accuracy, seconds, charts, docs/performance.md
	@$(PYTHON) -m tools.environments bench
	@$(MAIN) -m bench $(BENCH)

# make parity PARITY="lamps world_constant" measures some rows again and keeps the others.
parity: ## Compare with Cycles, feature by feature: docs/parity.md
	@$(PYTHON) -m tools.environments bench
	@$(MAIN) -m bench.parity $(PARITY)

# make stability STABILITY="gap wall" measures some sweeps again and keeps the others.
stability: ## Scenes made worse step by step until methods fail, ours beside other programs: docs/stability.md
	@$(PYTHON) -m tools.environments bench
	@$(MAIN) -m bench.stability $(STABILITY)

compare: ## The paper's table: adaptive against uniform subdivision at the same minimum size
	@$(PYTHON) -m tools.environments bench
	@$(MAIN) -m bench.compare $(COMPARE)

lint: venv ## Formatting, lint and types, without changing anything
	@$(MAIN) -m tools.run_tests lint

format: venv ## Format, and mend what the linter can mend
	@$(MAIN) -m ruff format .
	@$(MAIN) -m ruff check --fix .

clean: ## Remove what was built and made; the cache outside the checkout stays
	rm -rf .venv .cache .hypothesis .mypy_cache .ruff_cache .pytest_cache dist out wheels
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
