# SPDX-License-Identifier: MIT
# `make TARGET VARIABLE=value` forwards to `phong75 COMMAND --option value`; every target does its own
# set-up. `make` or `make help` lists the targets.

PYTHON := .venv/bin/python
PHONG75 := $(PYTHON) -m phong75.scripts.main

.DEFAULT_GOAL := help

# -- variables -------------------------------------------------------------------------------------

# What was set on the command line; a variable of the environment is not looked at.
given := $(foreach v,$(.VARIABLES),$(if $(filter command,$(firstword $(origin $v))),$v))
# The value of variable $1, if it was set; and as an argument for the shell, whatever is in it.
setting = $(if $(filter $1,$(given)),$($1))
quote = '$(subst ','\'',$(1))'

# Which variables each target takes. Any other is refused, before anything is run.
variables_run := SCENE SIZE TECHNIQUE CONFIG UNITS FPS CLOCK_MHZ PRUNE SPANS OUT
variables_convert := SCENE OUT
variables_compare := SCENE SIZE CLOCK_MHZ OUT RECORD
variables_prune := SCENE SIZE SEEDS GATES RECORD
variables_scenes := RECORD
variables_sweep := AREA ROUTE RECORD
variables_tessellation := RECORD
variables_stability := RECORD
variables_adversarial := KEEP RECORD
variables_prove := CONFIG AGAIN METHODS RECORD
variables_synth := CONFIG SCENE PRUNE GRADE SEEDS GATES RECORD
variables_netlist := RECORD
variables_formal := RECORD
variables_activity := RECORD
variables_waves := MODULE CONFIG
variables_bench := RECORD
variables_export := CONFIG OUT SCENE SIZE PRUNE
variables_mutate := FILES KIND SAMPLE AGAIN RECORD
variables_coverage := RECORD
variables_icarus := RECORD
variables_prune-random := SCENES RECORD
variables_mesh-fuzz := FILES FOLDER RECORD
variables_mesh-large := TRIANGLES RECORD
variables_test := RECORD
variables_test-all := RECORD

goals := $(or $(MAKECMDGOALS),help)
accepted := $(foreach goal,$(goals),$(variables_$(goal)))
unknown := $(filter-out $(accepted) PYTHON,$(given))
ifneq ($(strip $(unknown)),)
$(error `make $(goals)` has no variable $(firstword $(unknown)); it takes $(or $(strip $(accepted)),none))
endif
flags := RECORD KEEP GATES AREA AGAIN METHODS
wrong := $(foreach v,$(filter $(flags),$(given)),$(if $(filter-out 0 1,$($v))$(word 2,$($v)),$v))
ifneq ($(strip $(wrong)),)
$(error $(firstword $(wrong)) is `$($(firstword $(wrong)))`, not 0 or 1)
endif

# --size='640x480' of SIZE=640x480; nothing for a variable that is not set or empty.
option = $(if $(call setting,$2),$1=$(call quote,$(call setting,$2)))
# --record of RECORD=1.
flag = $(if $(filter 1,$(call setting,$2)),$1)
# An argument without a name, such as the scene: after all options, whatever it begins with.
argument = $(if $(call setting,$1),-- $(call quote,$(call setting,$1)))

record = $(call flag,--record,RECORD)
size = $(call option,--size,SIZE)
config = $(call option,--config,CONFIG)

# -- set-up ----------------------------------------------------------------------------------------

# Packages come in groups, so that a target installs only what it uses.
.PHONY: setup hardware-setup page-setup docs-setup all-setup
setup:
	@scripts/setup.sh
hardware-setup:
	@scripts/setup.sh hardware
page-setup:
	@scripts/setup.sh page
docs-setup:
	@scripts/setup.sh docs
all-setup:
	@scripts/setup.sh hardware page docs

# -- commands --------------------------------------------------------------------------------------

.PHONY: run convert compare prune scenes sweep tessellation stability adversarial prove report \
  synth netlist formal activity \
  waves bench export configs

run: setup
	@$(PHONG75) run $(size) $(call option,--technique,TECHNIQUE) $(config) $(call option,--units,UNITS) \
	  $(call option,--fps,FPS) $(call option,--clock,CLOCK_MHZ) $(call option,--prune,PRUNE) \
	  $(call option,--spans,SPANS) $(call option,--out,OUT) $(call argument,SCENE)

convert: setup
	@$(PHONG75) convert $(call option,--out,OUT) $(call argument,SCENE)

compare: setup
	@$(PHONG75) compare $(size) $(call option,--clock,CLOCK_MHZ) $(call option,--out,OUT) $(record) \
	  $(call argument,SCENE)

prune: $(if $(filter all,$(call setting,SCENE)),hardware-setup,setup)
	@$(PHONG75) prune $(size) $(call option,--seeds,SEEDS) $(call flag,--gates,GATES) $(record) \
	  $(call argument,SCENE)

scenes: setup
	@$(PHONG75) scenes $(record)

sweep: $(if $(filter-out 0,$(call setting,AREA) $(call setting,ROUTE)),hardware-setup,setup)
	@$(PHONG75) sweep $(call flag,--area,AREA) $(call option,--route,ROUTE) $(record)

tessellation: setup
	@$(PHONG75) tessellation $(record)

stability: setup
	@$(PHONG75) stability $(record)

adversarial: setup
	@$(PHONG75) adversarial $(or $(record),$(call flag,--record,KEEP))

prove: setup
	@$(PHONG75) prove $(config) $(call flag,--again,AGAIN) \
	  $(call flag,--methods,METHODS) $(record)

report: page-setup
	@$(PHONG75) report

synth: hardware-setup
	@$(PHONG75) synth $(config) $(or $(call option,--prune,PRUNE),$(call option,--prune,SCENE)) \
	  $(call option,--grade,GRADE) $(call option,--seeds,SEEDS) $(call flag,--gates,GATES) $(record)

netlist: hardware-setup
	@$(PHONG75) netlist $(record)

formal: hardware-setup
	@$(PHONG75) formal $(record)

activity: setup
	@$(PHONG75) activity $(record)

waves: setup
	@$(PHONG75) waves $(config) $(call argument,MODULE)

bench: setup
	@$(PHONG75) bench $(record)

export: setup
	@$(PHONG75) export $(config) $(call option,--out,OUT) $(call option,--scene,SCENE) \
	  $(call option,--size,SIZE) $(call option,--prune,PRUNE)

configs: setup
	@$(PHONG75) configs

# -- for developers --------------------------------------------------------------------------------

.PHONY: lint check test test-all test-report mutate coverage icarus prune-random mesh-fuzz \
  mesh-large docs clean

lint: setup
	@$(PYTHON) -m phong75.scripts.lint

check: setup
	@$(PYTHON) -m tests.run check

test: setup
	@$(PYTHON) -m tests.run test $(call flag,--record-durations,RECORD)

test-all: all-setup
	@$(PYTHON) -m tests.run all $(call flag,--record-durations,RECORD)

test-report: page-setup
	@command -v chromium >/dev/null || \
	  { echo 'The report page is tested in Chromium: apt-get install chromium' >&2; exit 2; }
	@$(PYTHON) -m pytest tests/page

mutate: setup
	@$(PYTHON) -m tests.campaigns.mutation $(call option,--kind,KIND) $(call option,--sample,SAMPLE) \
	  $(call flag,--again,AGAIN) $(record) -- $(foreach f,$(call setting,FILES),$(call quote,$f))

coverage: setup
	@$(PYTHON) -m tests.campaigns.coverage $(record)

icarus: setup
	@$(PYTHON) -m tests.campaigns.icarus $(record)

prune-random: setup
	@$(PYTHON) -m tests.campaigns.random_scenes $(call option,--scenes,SCENES) $(record)

mesh-fuzz: setup
	@$(PYTHON) -m tests.campaigns.mesh_fuzz $(call option,--files,FILES) \
	  $(call option,--folder,FOLDER) $(record)

mesh-large: setup
	@$(PYTHON) -m tests.campaigns.large_mesh $(call option,--triangles,TRIANGLES) $(record)

docs: docs-setup
	@$(PYTHON) -m phong75.scripts.docs

clean:
	@rm -rf build .hypothesis .ruff_cache
	@find . -name __pycache__ -not -path './.venv/*' -prune -exec rm -rf {} +

# -- help ------------------------------------------------------------------------------------------

.PHONY: help
help:
	@echo 'Render and look:'
	@echo '  make run           SCENE=teapot through RTL and model, compared; build/NAME/'
	@echo '                     SIZE=640x480 TECHNIQUE=phong|gouraud|flat CONFIG=NAME FPS=30'
	@echo '                     UNITS=1 CLOCK_MHZ=200 PRUNE=1|SCENE SPANS=FILE OUT=DIR'
	@echo '  make compare       SCENE=teapot in every shading on one sheet; build/NAME-compare/'
	@echo '                     SIZE=640x480 CLOCK_MHZ=200 OUT=DIR'
	@echo '  make convert       SCENE=FILE.scn of lecture notes to OUT=FILE.toml'
	@echo '  make prune         what SCENE needs of the pipeline; SCENE=all: what that saves'
	@echo '                     SIZE=640x480 SEEDS=3 GATES=1'
	@echo '  make scenes        all bundled scenes at three sizes'
	@echo '  make report        one page of all results'
	@echo '  make waves         MODULE=phong_pipeline CONFIG=NAME: a waveform for GTKWave'
	@echo '  make configs       the names that CONFIG takes'
	@echo '  make export        CONFIG=NAME OUT=DIR: a folder with the design, for other tools'
	@echo 'Measure:'
	@echo '  make sweep         error, run time, hardware of all CONFIGs; AREA=1 ROUTE=1|NAMES'
	@echo '  make tessellation  error against true surfaces (part of make sweep)'
	@echo '  make stability     stiff and extreme cases'
	@echo '  make adversarial   search for the largest error; KEEP=1 keeps a worse input'
	@echo '  make prove         certified bounds of the error; CONFIG=NAME AGAIN=1 METHODS=1'
	@echo '  make bench         speed of simulation and model'
	@echo 'Hardware:'
	@echo '  make synth         size and clock on a Lattice ECP5'
	@echo '                     CONFIG=NAME SCENE=torus GRADE=6|8 SEEDS=3 GATES=1'
	@echo '  make netlist       frames through the netlist'
	@echo '  make formal        proofs of the flow control'
	@echo '  make activity      register toggles a pixel'
	@echo 'Develop:'
	@echo '  make check         the fast tests; make test: all that need no tools besides;'
	@echo '                     make test-all: everything, as CI'
	@echo '  make lint          Verilator -Wall, Verible, Ruff'
	@echo '  make test-report   the report page in Chromium'
	@echo '  make mutate        change each constant and operator of rtl/'
	@echo '                     FILES="a b" KIND=constant|operator SAMPLE=20 AGAIN=1'
	@echo '  make coverage      coverage of rtl/; make icarus: the module tests with unknown values'
	@echo '  make prune-random  SCENES=200: random scenes on the builds pruned to them'
	@echo '  make mesh-fuzz     FILES=10000 FOLDER=DIR: mutated mesh files; make mesh-large:'
	@echo '                     TRIANGLES=10000000 from file to spans'
	@echo '  make docs          the documentation, build/docs/'
	@echo '  make setup         install what make run and make test use; make clean: remove build/'
	@echo 'RECORD=1 writes the figures of a long run into results/, unless a better run is there.'
	@echo 'The same as a program with more options: .venv/bin/phong75 --help'
