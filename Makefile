.PHONY: build
build:
	cargo build --release --quiet --manifest-path rust/Cargo.toml --features extension-module
	cp rust/target/release/lib_kernels.so src/vedette/_kernels.new && mv src/vedette/_kernels.new src/vedette/_kernels.abi3.so
