# The tests of mechanics run in debug and in release: overflow and debug assertions show in the
# one, what the optimiser makes of the numerics in the other.
CARGO ?= cargo

PYTHON ?= python3
# Where the tests of the Python package have their packages.
VENV ?= target/venv
# A Python that may have PyTorch: from PyPI it comes with gigabytes for graphics cards.
TORCH_PYTHON ?= /usr/bin/python3
TORCH_VENV ?= target/venv-torch

# The same random cases each time: what is found by others is found on purpose, with another number
# here, and becomes a test of its own.
export PROPTEST_RNG_SEED ?= 1

.PHONY: test test-rust fmt fmt-check lint doc test-debug test-release bench-build bench wheel installed test-python test-torch docs test-docs bench-python

test: test-rust test-python test-torch test-docs

# All that needs Rust alone.
test-rust: fmt-check lint doc test-debug test-release bench-build

fmt:
	$(CARGO) fmt --all

fmt-check:
	$(CARGO) fmt --all --check

lint:
	$(CARGO) clippy --workspace --all-targets --locked -- -D warnings

doc:
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --workspace --no-deps --locked

# Unit, property, reference, snapshot and documentation tests.
test-debug:
	$(CARGO) test --workspace --locked

test-release:
	$(CARGO) test --workspace --locked --release

bench-build:
	$(CARGO) bench --workspace --locked --no-run

bench:
	$(CARGO) bench --workspace --locked

$(VENV)/bin/maturin:
	$(PYTHON) -m venv $(VENV)
	$(VENV)/bin/pip install --quiet --disable-pip-version-check "maturin>=1.9.4,<2"

# The Python package, in target/wheels.
wheel: $(VENV)/bin/maturin
	rm -rf target/wheels
	PATH="$(abspath $(VENV))/bin:$$PATH" $(VENV)/bin/maturin build --release --out target/wheels

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
