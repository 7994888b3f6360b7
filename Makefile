# make demo | gui | report-demo | test | lint | real | bench | docs | screenshots | package | audit | system-packages | clean.
# Python 3.11 or newer; everything goes into .venv.
SHELL := /bin/sh
# A name may stand on the path and still not run (version managers leave such shims), so each is tried.
PYTHON ?= $(shell for p in python3.13 python3.12 python3.11 python3 python; do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1 && { echo $$p; break; }; done)
LOCK := constraints/constraints.txt
BIN := .venv/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check
INSTALL := $(PIP) install --quiet --constraint $(LOCK)

.PHONY: demo gui report-demo test lint real bench docs screenshots package audit system-packages clean python

demo: .venv/.installed
	$(BIN)/geofit demo --out demo_out

report-demo: .venv/.installed
	$(BIN)/geofit report sample_data/site.toml --lang en --out report_demo/en
	$(BIN)/geofit report sample_data/site.toml --lang zh --out report_demo/zh

gui: .venv/.installed
	$(INSTALL) --editable '.[gui]'
	$(BIN)/geofit-gui

test: .venv/.installed-test
	@bash tools/system_packages.sh missing || true
	$(BIN)/python -m pytest

audit: .venv/.installed-test
	$(BIN)/python tools/audit.py

system-packages:
	bash tools/system_packages.sh

lint: .venv/.installed-lint
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/python tools/catalogue.py --check
	rm -rf build
	$(PIP) install --quiet --no-deps --no-build-isolation --target build/typecheck .
	cd build && MYPYPATH=typecheck ../$(BIN)/python -m mypy --config-file ../pyproject.toml -p geofit

real: .venv/.installed-test
	$(BIN)/python benchmarks/real.py

bench: .venv/.installed-test
	@set -e; for script in benchmarks/fit.py benchmarks/distance.py benchmarks/scale.py; do $(BIN)/python $$script; done

docs: .venv/.installed-docs
	rm -rf build/docs
	$(PIP) install --quiet --no-deps --no-build-isolation --target build/docs/package .
	$(BIN)/python tools/build_docs.py pages
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict --quiet
	$(BIN)/python tools/build_docs.py links

screenshots: .venv/.installed-test
	$(BIN)/python tools/screenshots.py

package: .venv/.installed-test
	$(INSTALL) 'pyinstaller>=6.10' 'setuptools>=77'
	rm -rf build/package
	$(PIP) install --quiet --no-deps --no-build-isolation --target build/package/site .
	$(BIN)/pyinstaller --noconfirm --log-level WARN --workpath build/package --distpath dist packaging/geofit.spec
	$(BIN)/python packaging/try_package.py dist/geofit

clean:
	rm -rf .venv build dist demo_out examples_out report_demo real_out .pytest_cache .mypy_cache .ruff_cache .hypothesis geofit.egg-info

python:
	@echo $(PYTHON)

.venv/bin/python:
	@test -n "$(PYTHON)" || { echo "Python 3.11 or newer is needed; none was found. Install it, or name it: make $(MAKECMDGOALS) PYTHON=/path/to/python3"; exit 1; }
	$(PYTHON) -m venv .venv

.venv/.installed: .venv/bin/python pyproject.toml $(LOCK)
	$(INSTALL) --editable .
	@touch $@

.venv/.installed-test: .venv/.installed
	$(INSTALL) --editable '.[gui,gis,las,xlsx,ifc,geoh5,test]'
	@touch $@

.venv/.installed-lint: .venv/.installed-test
	$(INSTALL) --editable '.[lint]' 'setuptools>=77'
	@touch $@

.venv/.installed-docs: .venv/.installed
	$(INSTALL) --editable '.[docs]' 'setuptools>=77'
	@touch $@
