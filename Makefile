# One door for every chore; CI calls the same targets.
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
# Versions that the tests were run with; the package itself accepts ranges.
CONSTRAINTS := .ci/constraints.txt
SOURCES := pyproject.toml $(shell find engine worker service proto -type f -not -path '*/__pycache__/*' -not -name '*.so')
SAMPLE := worker/partuv_worker/samples/robot.glb

.PHONY: run test bench lint type format sanitize stubs judges fuzz clean help

help:  ## list the targets
	@grep -E '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## / - /'

run: $(BIN)/.run  ## set up, start the service, unwrap the sample through it, stop
	mkdir -p out
	$(BIN)/partuv serve --port 0 --grpc-port 0 --data out/service --submit $(SAMPLE) -o out/robot.glb --report out/robot.json --preview out/robot.png --stop

test: $(BIN)/.dev  ## set up and run the test suite
	$(BIN)/python -m pytest

bench: $(BIN)/.bench  ## compare with other tools, on MESHES=folder or own shapes: docs/benchmarks.md
	$(BIN)/python -m bench.compare $(MESHES)

lint: $(BIN)/.dev  ## style of Python and C++, and who may import whom
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	find engine -name '*.[ch]pp' | xargs $(BIN)/clang-format --dry-run -Werror
	$(BIN)/lint-imports

type: $(BIN)/.dev  ## strict types
	$(BIN)/mypy

format: $(BIN)/.dev  ## rewrite sources in the house style
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	find engine -name '*.[ch]pp' | xargs $(BIN)/clang-format -i

sanitize: $(BIN)/.dev  ## C++ tests of the engine under AddressSanitizer and UBSan
	$(BIN)/cmake -S engine -B build/sanitize -DCMAKE_BUILD_TYPE=RelWithDebInfo -DPARTUV_SANITIZE=ON -DPARTUV_BINDINGS=OFF -DPARTUV_TESTS=ON -DPython_EXECUTABLE=$(abspath $(BIN))/python
	$(BIN)/cmake --build build/sanitize --parallel 2
	cd build/sanitize && $(abspath $(BIN))/ctest --parallel 2 --output-on-failure

stubs: $(BIN)/.dev  ## write the types of the extension anew
	$(BIN)/python -m nanobind.stubgen -m partuv_engine._core -o engine/partuv_engine/_core.pyi

judges:  ## install the glTF readers that judge results in the tests (needs npm)
	npm install --prefix tests/judges --no-package-lock --no-audit --no-fund

fuzz: $(BIN)/.dev  ## fuzz the reader and the engine's binding for a minute each
	$(BIN)/pip install --quiet 'atheris>=3,<4'
	$(BIN)/python -m tests.fuzz.fuzz_reader -max_total_time=60 -len_control=0 -max_len=512
	$(BIN)/python -m tests.fuzz.fuzz_engine -max_total_time=60 -max_len=16

clean:  ## remove what the other targets made
	rm -rf build out $(VENV)

$(BIN)/python:
	$(PYTHON) -m venv $(VENV)

$(BIN)/.run: $(SOURCES) | $(BIN)/python
	$(BIN)/pip install --quiet --constraint $(CONSTRAINTS) '.[worker,service]'
	touch $@

$(BIN)/.dev: $(SOURCES) | $(BIN)/python
	$(BIN)/pip install --quiet --constraint $(CONSTRAINTS) '.[dev,partfield]'
	touch $@

$(BIN)/.bench: $(SOURCES) | $(BIN)/python
	$(BIN)/pip install --quiet --constraint $(CONSTRAINTS) '.[bench]'
	touch $@
