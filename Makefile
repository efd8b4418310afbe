# The commands of the README. `make demo` and `make test` do all the set-up on a fresh Debian or Ubuntu with Rust.

SHELL := /bin/sh
DEMO := demo
FUZZ_SECONDS := 60
LUNULA := target/release/lunula
# Real recordings, which don't come with the repository.
REAL_DATA := $(or $(LUNULA_REAL_DATA),../shared/data)
PACKAGES := $(shell sed '/^\#/d' system-packages.txt)

.PHONY: help demo test lint msrv bench peers fuzz system browser clean

help:
	@echo "make demo   build, run the main jobs on generated scenes, say where the pictures are"
	@echo "make test   build and run every test; those of real recordings where LUNULA_REAL_DATA or ../shared/data has them"
	@echo "make lint   formatting, clippy and documentation, all without warnings"
	@echo "make msrv   compile with the oldest Rust that Cargo.toml promises"
	@echo "make bench  speed against only decoding, and against Python with OpenCV, scikit-image, pandas"
	@echo "make peers  other programs on the scenes of \`lunula tradeoff\`, for its --peers: bench/runs/DATE-MACHINE/peers.csv"
	@echo "make fuzz   look for inputs that make a parser panic, abort or hang: FUZZ_SECONDS=60 each, PARSERS=\"csv xdf\" for some"

demo: system
	@mkdir -p $(DEMO)
	@echo "1 of 3: building lunula (4 to 15 minutes the first time)"
	cargo build --release --locked
	@echo "2 of 3: one scene for each job (half a minute)"
	$(LUNULA) phantom photos --seed 1 --light chamber --out $(DEMO)/scene
	$(LUNULA) photos $(DEMO)/scene/photos --out $(DEMO)/coloration
	@echo
	@echo "Average coloration of 16 generated subjects in eight poses:"
	@echo "  $(DEMO)/coloration/report.html            everything on one page"
	@echo "  $(DEMO)/coloration/figures/contrast.png   as Fig. 54 of the thesis"
	@echo "  $(DEMO)/scene/truth/maps                  the exact maps, to compare"
	@echo
	$(LUNULA) phantom video --seed 1 --out $(DEMO)/finger --vfr --clock mm:ss.t
	$(LUNULA) phantom log --seed 1 --out $(DEMO)/finger
	$(LUNULA) posture $(DEMO)/finger/video.mp4 --markers $(DEMO)/finger/markers.toml --out $(DEMO)/posture/joints.csv --overlay $(DEMO)/posture/overlay.mp4
	@echo
	@echo "Joint angles of a generated video of a bending finger:"
	@echo "  $(DEMO)/posture/joints-angles.png         the angles over time"
	@echo "  $(DEMO)/posture/joints-coupling.png       J3 against J2, as Fig. 33 of the thesis"
	@echo "  $(DEMO)/posture/overlay.mp4               the video with what was tracked"
	@echo "  $(DEMO)/finger/truth/joints.csv           the exact angles, to compare"
	@echo
	$(LUNULA) align --joints $(DEMO)/posture/joints.csv --log $(DEMO)/finger/log.csv --out $(DEMO)/align/training.csv
	@echo
	@echo "The angles on the samples of a generated log of photodiodes, by the clock in the picture:"
	@echo "  $(DEMO)/align/training.csv                the labelled set"
	@echo "  $(DEMO)/align/training.sync.json          its certificate"
	@echo "  $(DEMO)/align/training-labels.png         labels over photodiodes"
	@echo
	$(LUNULA) phantom log --protocol touch --seed 1 --out $(DEMO)/touch/1
	$(LUNULA) phantom log --protocol touch --seed 2 --out $(DEMO)/touch/2
	$(LUNULA) phantom log --protocol touch --seed 3 --out $(DEMO)/touch/3
	$(LUNULA) phantom log --protocol touch-random --seed 4 --out $(DEMO)/touch/random
	$(LUNULA) train $(DEMO)/touch/1/log.csv $(DEMO)/touch/2/log.csv --target force --validate $(DEMO)/touch/3/log.csv --out $(DEMO)/predictor/force.json
	$(LUNULA) evaluate $(DEMO)/predictor/force.json $(DEMO)/touch/random/log.csv --out $(DEMO)/predictor/random
	$(LUNULA) analyse $(DEMO)/predictor/force.json --out $(DEMO)/predictor/modes
	$(LUNULA) prune $(DEMO)/touch/1/log.csv $(DEMO)/touch/2/log.csv --validate $(DEMO)/touch/3/log.csv --out $(DEMO)/predictor/prune
	@echo
	@echo "Forces predicted from photodiodes, trained on two generated spirals:"
	@echo "  $(DEMO)/predictor/random/over-time.png    predicted and measured on random movement, as Fig. 99"
	@echo "  $(DEMO)/predictor/random/scatter.png      the same as Fig. 100"
	@echo "  $(DEMO)/predictor/modes/modes.png         singular values and modes, as Fig. 98"
	@echo "  $(DEMO)/predictor/prune/without-one.png   each photodiode removed, as Fig. 113"
	@echo
	$(LUNULA) simulate --pf1 step:5000@0..2 --pf2 step:5000@0..2 --with-loads --out $(DEMO)/hemodynamics/steps.csv
	$(LUNULA) simulate --static 0..12000/50 --load distal --out $(DEMO)/hemodynamics/static.csv
	$(LUNULA) fit $(DEMO)/hemodynamics/steps.csv --free k_C,b_C,k_V,b_V --set k_C1_N_per_m=7e4 --set k_C2_N_per_m=7e4 --set k_V_N_per_m=1500 --between held --unloaded-before --out $(DEMO)/hemodynamics/fit.json
	@echo
	@echo "Blood under the nail, and its model fitted to what the photodiodes saw:"
	@echo "  $(DEMO)/hemodynamics/steps-response.png   the response to a press"
	@echo "  $(DEMO)/hemodynamics/fit-fitted.png       the fit"
	@echo
	@echo "3 of 3: the whole study of the thesis, on generated people (1 to 5 minutes; all of the above is there to look at)"
	$(LUNULA) run pipelines/study.toml --out $(DEMO)/study
	@echo
	@echo "The whole study, a counterpart of every data figure of the thesis:"
	@echo "  $(DEMO)/study/page/study.html             the figures, and what the thesis states beside what came out"
	@echo "  $(DEMO)/study/report.html                 what was done and left out, errors, the time of each stage"

# Every package but diffsol's and the fuzzer's, which take minutes to compile.
ALL := --locked --features xdf --workspace --exclude lunula-hemodynamics-peer --exclude lunula-fuzz

# Tests that need real recordings are ignored; where the recordings are, they are run by name. Those of bench/peers run
# with it.
test: TESTED := $(ALL) --exclude lunula-peers
test: system
	cargo test $(TESTED)
	@if [ -d "$(REAL_DATA)" ]; then \
	  set -x; LUNULA_REAL_DATA="$(abspath $(REAL_DATA))" cargo test $(TESTED) real_data:: -- --ignored; \
	else \
	  left_out=$$(cargo test --quiet $(TESTED) real_data:: -- --ignored --list | grep -c ': test$$'); \
	  echo "left out: $$left_out tests of real recordings; LUNULA_REAL_DATA names their folder"; \
	fi
	@if command -v chromedriver >/dev/null; then \
	  set -x; cargo test $(TESTED) in_browser -- --ignored; \
	else \
	  left_out=$$(cargo test --quiet $(TESTED) in_browser -- --ignored --list | grep -c ': test$$'); \
	  echo "left out: $$left_out tests of pages; they need chromium and its driver (make browser)"; \
	fi

lint: system
	cargo fmt --all --check
	cargo clippy $(ALL) --features lsl --all-targets -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc $(ALL) --features lsl --no-deps

# The oldest Rust that Cargo.toml promises; where it is the one in use, all else compiles with it.
msrv: MSRV := $(shell sed -n 's/^rust-version = "\(.*\)"/\1.0/p' Cargo.toml)
msrv: system
	@if rustc --version | grep -qF " $(MSRV) "; then \
	  echo "left out: rustc is $(MSRV), the oldest Rust promised"; \
	else \
	  set -x; rustup run --install $(MSRV) cargo check $(ALL) --all-targets; \
	fi

bench: system
	cargo bench --locked --bench photos
	cargo bench --locked --bench posture
	cargo bench --locked -p lunula-cli --bench nailvideo
	cargo bench --locked --bench align
	cargo bench --locked -p lunula-cli --bench live
	cargo bench --locked -p lunula-predictor
	cargo bench --locked -p lunula-hemodynamics
	cargo test --locked --release -p lunula-hemodynamics-peer

# The packages of bench/peers/requirements.txt that python3 lacks are named, and what needs them is left out.
peers: system
	cargo test --release --locked -p lunula-peers --features diffsol
	cargo run --release --locked -p lunula-peers --features diffsol

# Installs cargo-afl below target/ where it is missing.
fuzz: system
	FUZZ_SECONDS=$(FUZZ_SECONDS) crates/fuzz/fuzz.sh $(PARSERS)

# A browser for the tests of pages, which are left out where there is none.
browser: PACKAGES := $(shell sed '/^\#/d' browser-packages.txt)
browser: system

# Installs the packages of system-packages.txt that are missing; does nothing where all are there.
system:
	@command -v cargo >/dev/null || { echo "Rust is missing: https://rustup.rs tells how to install it" >&2; exit 1; }
	@command -v dpkg-query >/dev/null || { echo "no Debian or Ubuntu: make sure that these are there: $(PACKAGES)"; exit 0; }; \
	missing=""; \
	for package in $(PACKAGES); do \
	  dpkg-query -W -f '$${Status}' $$package 2>/dev/null | grep -q 'ok installed' || missing="$$missing $$package"; \
	done; \
	[ -z "$$missing" ] && exit 0; \
	echo "installing$$missing"; \
	if [ "$$(id -u)" = 0 ]; then as=""; else as=sudo; fi; \
	$$as apt-get update -q && $$as apt-get install -y --no-install-recommends $$missing

clean:
	cargo clean
	rm -rf $(DEMO)
