CARGO ?= cargo

# The crates of mechanics are tested in release with default flags: what the optimiser makes of the numerics counts. All
# other tests run in the profile dev, which compiles fast and has debug assertions and overflow checks, those of the
# mechanics under them included. `make test-long` runs the tests of mechanics in that profile as well.
MECHANICS := whipcord-numerics whipcord whipcord-estimation whipcord-inverse whipcord-motion whipcord-design

PYTHON ?= python3
# Where the tests of the Python package have their packages.
VENV ?= target/venv
# A Python that may have PyTorch: from PyPI it comes with gigabytes for graphics cards.
TORCH_PYTHON ?= /usr/bin/python3
TORCH_VENV ?= target/venv-torch

# The viewer's page, which is TypeScript: built by Node 20.19 or later, tested in the system's Chromium. All else needs neither.
PAGE := crates/whipcord-viewer/page
NPM ?= npm
CHROMIUM ?= $(shell command -v chromium || command -v chromium-browser || command -v google-chrome)
HAS_NODE := command -v $(NPM) >/dev/null && node -e 'const [a, b] = process.versions.node.split("."); process.exit(a > 20 || (a == 20 && b >= 19) ? 0 : 1)' 2>/dev/null

# The same random cases each time: what is found by others is found on purpose, with another number
# here, and becomes a test of its own.
export PROPTEST_RNG_SEED ?= 1

.PHONY: test test-long test-damaged test-studies test-mechanics-checked test-rust page page-where-node test-page fmt fmt-check lint doc test-mechanics test-others bench wheel sdist installed install-c test-c test-python test-torch docs test-docs bench-python

# What is left when Rust is tested keeps no core busy all the time, so that two at a time take less long.
test: page-where-node test-rust
	$(MAKE) --no-print-directory --jobs 2 --output-sync=target test-page test-c test-python test-torch test-docs

# All that needs Rust alone.
test-rust: fmt-check lint doc test-mechanics test-others

fmt:
	$(CARGO) fmt --all

fmt-check:
	$(CARGO) fmt --all --check

# Checks the benchmarks too, and what a build without boards has in their place.
lint:
	$(CARGO) clippy --workspace --all-targets --locked -- -D warnings
	$(CARGO) clippy -p whipcord-vision --lib --locked -- -D warnings

doc:
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --workspace --no-deps --locked

# Unit, property, reference, snapshot and documentation tests. The Python package has none: it is named so that cargo unites
# features as for the wheel, which then takes the crates of mechanics from here.
test-mechanics:
	$(CARGO) test $(MECHANICS:%=-p %) -p whipcord-py --locked --release

OTHERS := --workspace $(MECHANICS:%=--exclude %) --locked

test-others:
	$(CARGO) test $(OTHERS)

# What takes too long for every change.
test-long: test-damaged test-studies test-mechanics-checked

# Damaged files of every kind, by the tens of thousands: `make test` runs a few hundred of each. FUZZ_SEED=7 takes others,
# FUZZ_SCALE=3 three times as many, 0.1 a tenth. What was not answered is kept in target/fuzz.
test-damaged:
	$(CARGO) test -p whipcord-cli --locked --release --test fuzz -- --ignored --exact \
	    damaged_files_of_every_kind_are_answered \
	    the_largest_photographs_are_measured_in_the_stated_memory \
	    --nocapture --test-threads=1

# Convergence, coverage and accuracy, with the tables of docs/theory.
test-studies:
	$(CARGO) test $(MECHANICS:%=-p %) -p whipcord-py --locked --release --tests -- --ignored --nocapture
	$(CARGO) test -p whipcord-vision --locked --release --test photographs -- --ignored --nocapture
	$(CARGO) test -p whipcord-cli --locked --release --test command -- --ignored

# The tests of mechanics with debug assertions and overflow checks.
test-mechanics-checked:
	$(CARGO) test $(MECHANICS:%=-p %) --locked

bench:
	$(CARGO) bench --workspace --locked

$(PAGE)/node_modules/.package-lock.json: $(PAGE)/package-lock.json $(PAGE)/package.json
	cd $(PAGE) && $(NPM) ci
	touch $@

# The viewer's page, which the next build of Rust embeds.
page: $(PAGE)/dist/index.html

# Only where its sources have changed: else that next build would be for nothing.
$(PAGE)/dist/index.html: $(PAGE)/node_modules/.package-lock.json $(wildcard $(PAGE)/src/* $(PAGE)/tests/* $(PAGE)/*.ts $(PAGE)/*.json $(PAGE)/index.html)
	cd $(PAGE) && $(NPM) run check && $(NPM) run build

page-where-node:
	@if $(HAS_NODE); then \
	    $(MAKE) --no-print-directory page; \
	else \
	    echo "skipped: no Node 20.19 or later with npm, so that \`whipcord view\` is built without its page" >&2; \
	fi

# The page by itself, and in a browser beside `whipcord view`, which is that of `test-others`: another selection of crates has
# other features and is built anew. Screenshots go to target/viewer.
test-page: page-where-node
	@if $(HAS_NODE) && [ -n "$(CHROMIUM)" ]; then \
	    set -ex; \
	    $(CARGO) test $(OTHERS) --no-run; \
	    cd $(PAGE); \
	    $(NPM) test; \
	    CHROMIUM="$(CHROMIUM)" $(NPM) run browser; \
	else \
	    echo "skipped: the viewer's page is tested with Node 20.19 or later and Chromium (Debian: apt-get install nodejs npm chromium)" >&2; \
	fi

# The C and C++ library with its headers, under a prefix of one's own: make install-c PREFIX=$$HOME/.local
install-c:
	@[ -n "$(PREFIX)" ] || { echo "give the folder to install to: make install-c PREFIX=\$$HOME/.local" >&2; exit 2; }
	$(CARGO) build --release --locked -p whipcord-c
	crates/whipcord-c/package/install.sh "$(PREFIX)" target/release

# The library as people install it: from a prefix, in an empty folder, beside the command, which is that of the wheel: by
# itself it would be built with other features.
test-c:
	@if command -v gcc >/dev/null && command -v g++ >/dev/null; then \
	    set -ex; \
	    $(CARGO) build --release --locked -p whipcord-c; \
	    $(CARGO) build --release --locked -p whipcord-cli -p whipcord-py --bin whipcord; \
	    crates/whipcord-c/package/test.sh target/release target/release/whipcord; \
	else \
	    echo "skipped: the C interface is tested with gcc and g++ (Debian: apt-get install g++)" >&2; \
	fi

$(VENV)/bin/maturin:
	$(PYTHON) -m venv $(VENV)
	$(VENV)/bin/pip install --quiet --disable-pip-version-check "maturin>=1.9.4,<2"

# The Python package, in target/wheels.
wheel: $(VENV)/bin/maturin page-where-node
	rm -rf target/wheels
	PATH="$(abspath $(VENV))/bin:$$PATH" $(VENV)/bin/maturin build --release --out target/wheels

# The sources of the Python package, with the built page, in target/wheels.
sdist: $(VENV)/bin/maturin page-where-node
	$(VENV)/bin/maturin sdist --out target/wheels

installed: wheel
	$(VENV)/bin/pip uninstall --quiet --yes whipcord
	$(VENV)/bin/pip install --quiet --disable-pip-version-check "$$(ls target/wheels/*.whl)[test,docs]"

# The package as people install it: its tests, the examples in its documentation, and its types.
test-python: installed
	$(VENV)/bin/python -m pytest python/tests --pyargs whipcord
	$(VENV)/bin/python -m mypy

test-torch: wheel
	@if $(TORCH_PYTHON) -c "import torch" 2>/dev/null; then \
	    set -ex; \
	    $(TORCH_PYTHON) -m venv --clear --system-site-packages $(TORCH_VENV); \
	    $(TORCH_VENV)/bin/pip install --quiet --disable-pip-version-check "numpy<2" matplotlib pytest target/wheels/*.whl; \
	    $(TORCH_VENV)/bin/python -m pytest python/tests/test_torch.py --pyargs whipcord.torch; \
	else \
	    echo "skipped: $(TORCH_PYTHON) has no PyTorch (Debian: apt-get install python3-torch)"; \
	fi

# The site, in target/docs. Its tutorials are run; what fails or warns fails the build.
docs: installed
	PATH="$(abspath $(VENV))/bin:$$PATH" $(VENV)/bin/sphinx-build -W --keep-going -q -d target/doctrees docs target/docs

test-docs: docs

bench-python: wheel
	$(VENV)/bin/pip install --quiet --disable-pip-version-check --force-reinstall --no-deps target/wheels/*.whl
	$(VENV)/bin/python python/benchmarks/overhead.py
