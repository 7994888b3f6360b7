# make demo | gui | report-demo | test | lint | real | bench | profile | docs | screenshots | package | wheel | audit | system-packages | clean.
# Python 3.11 or newer; everything goes into .venv.
SHELL := /bin/sh
# A name may stand on the path and still not run (version managers leave such shims), so each is tried.
PYTHON ?= $(shell for p in python3.13 python3.12 python3.11 python3 python; do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1 && { echo $$p; break; }; done)
LOCK := constraints/constraints.txt
# The same versions with the SHA-256 of every file; pip takes no editable install while it checks hashes.
HASHES := constraints/hashes.txt
BIN := .venv/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check
INSTALL := $(PIP) install --quiet --constraint $(LOCK)

.PHONY: demo gui report-demo test test-windows test-volumes test-files test-others lint real bench profile docs screenshots package wheel audit system-packages clean python

demo: .venv/.installed
	$(BIN)/geofit demo --out demo_out

report-demo: .venv/.installed
	$(BIN)/geofit report sample_data/site.toml --lang en --out report_demo/en
	$(BIN)/geofit report sample_data/site.toml --lang zh --out report_demo/zh

gui: .venv/.installed
	$(INSTALL) --editable '.[gui]'
	$(BIN)/geofit-gui

# Four parts that share nothing but the processor, the longest first: make -j2 test runs two side by side.
WINDOWS := tests/gui
VOLUMES := tests/bodies tests/caves tests/implicit tests/medial tests/morphing tests/pores
FILES := tests/cad tests/cli tests/io tests/project tests/report
PARTS := test-windows test-volumes test-files test-others
# Threads of linear algebra on small matrices wait for each other where another part runs next to them: tenfold time.
$(PARTS): export OPENBLAS_NUM_THREADS ?= 1
$(PARTS): export OMP_NUM_THREADS ?= 1
test: .venv/.installed-all
	@bash tools/system_packages.sh missing || true
	@$(MAKE) --keep-going $(PARTS)

# Exit code 5: where no window can open, every test of them is skipped. From 128 on a signal ended the process: Qt, VTK or
# the OpenGL driver crashed, and the dump above says where. The tests run once more; a second crash fails.
test-windows: .venv/.installed-all
	$(BIN)/python -m pytest $(WINDOWS) || case $$? in \
		5) ;; \
		1[2-9][0-9]) echo "WARNING: the tests of the windows crashed; they run once more."; \
			$(BIN)/python -m pytest $(WINDOWS) ;; \
		*) exit 1 ;; esac

test-volumes: .venv/.installed-all
	$(BIN)/python -m pytest $(VOLUMES)

test-files: .venv/.installed-all
	$(BIN)/python -m pytest $(FILES)

test-others: .venv/.installed-all
	$(BIN)/python -m pytest $(addprefix --ignore=,$(WINDOWS) $(VOLUMES) $(FILES))

audit: .venv/.installed-all
	-@$(PIP) install --quiet pip-audit
	$(BIN)/python tools/audit.py

system-packages:
	bash tools/system_packages.sh

lint: .venv/.installed-all
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/python tools/catalogue.py --check
	$(BIN)/python tools/schema.py --check
	$(BIN)/python tools/settings_page.py --check
	$(BIN)/python tools/prose.py
	rm -rf build
	$(PIP) install --quiet --no-deps --no-build-isolation --target build/typecheck .
	cd build && MYPYPATH=typecheck ../$(BIN)/python -m mypy --config-file ../pyproject.toml -p geofit

real: .venv/.installed-all
	$(BIN)/python benchmarks/real.py

# The peers have an environment of their own: they hold back what geofit needs, or bring much that it does not.
bench: .venv/.installed-all
	test -d build/peers || $(PYTHON) -m venv build/peers
	build/peers/bin/python -m pip --disable-pip-version-check install --quiet -r benchmarks/peers/requirements.txt
	$(PIP) install --quiet 'polars>=1.0'
	$(BIN)/python benchmarks/bench.py --peers build/peers/bin/python
	$(BIN)/python benchmarks/pores.py
	$(BIN)/python benchmarks/scale.py

profile: .venv/.installed-all
	$(BIN)/python benchmarks/costs.py

docs: .venv/.installed-all
	rm -rf build/docs
	$(PIP) install --quiet --no-deps --no-build-isolation --target build/docs/package .
	$(BIN)/python tools/build_docs.py pages
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict --quiet
	$(BIN)/python tools/build_docs.py links

screenshots: .venv/.installed-all
	$(BIN)/python tools/screenshots.py

package: .venv/.installed-all
	$(INSTALL) 'pyinstaller>=6.10'
	rm -rf build/package
	$(PIP) install --quiet --no-deps --no-build-isolation --target build/package/site .
	$(BIN)/pyinstaller --noconfirm --log-level WARN --workpath build/package --distpath dist packaging/geofit.spec
	$(BIN)/python packaging/try_package.py dist/geofit

# Both archives, the wheel from the unpacked sdist, tried in an environment of its own.
wheel: .venv/.installed-all
	$(BIN)/python tools/try_wheel.py

clean:
	rm -rf .venv build dist demo_out examples_out report_demo real_out .pytest_cache .mypy_cache .ruff_cache .hypothesis *.egg-info

python:
	@echo $(PYTHON)

.venv/bin/python:
	@test -n "$(PYTHON)" || { echo "Python 3.11 or newer is needed; none was found. Install it, or name it: make $(MAKECMDGOALS) PYTHON=/path/to/python3"; exit 1; }
	$(PYTHON) -m venv .venv

.venv/.installed: .venv/bin/python pyproject.toml $(LOCK)
	$(INSTALL) --editable .
	@touch $@

# All extras, each file checked against its hash.
.venv/.installed-all: .venv/bin/python pyproject.toml $(HASHES)
	$(PIP) install --quiet --no-deps --require-hashes --requirement $(HASHES)
	$(PIP) install --quiet --no-deps --no-build-isolation --editable .
	@touch .venv/.installed $@
