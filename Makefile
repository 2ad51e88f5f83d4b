# The tests of mechanics run in debug and in release: overflow and debug assertions show in the
# one, what the optimiser makes of the numerics in the other.
CARGO ?= cargo

.PHONY: test fmt fmt-check lint doc test-debug test-release bench-build bench

test: fmt-check lint doc test-debug test-release bench-build

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
