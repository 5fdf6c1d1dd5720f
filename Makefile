# Every target does its own set-up. `make` or `make help` lists them.

SCENE ?= teapot
SIZE ?=
FPS ?= 30
CLOCK_MHZ ?= 200
OUT ?=
SPANS ?=
TECHNIQUE ?= phong
PRUNE ?=
MODULE ?= phong_pipeline
CONFIG ?= default
GRADE ?= 6
SEEDS ?= 3
AREA ?=
ROUTE ?=
GATES ?=

PYTHON := .venv/bin/python
# An argument for the shell, whatever is in it.
quote = '$(subst ','\'',$(1))'

.DEFAULT_GOAL := help
.PHONY: help setup run prune check test lint results bench sweep tessellation synth netlist icarus formal coverage activity mutate \
  hardware waves clean

help: ## this list
	@echo 'make run      render SCENE through the RTL and the model, compare, write pictures and report'
	@echo '                SCENE=teapot    a bundled scene, or a path to a scene file or a mesh'
	@echo '                SIZE=640x480    width x height; else the size that the scene gives'
	@echo '                TECHNIQUE=phong interpolates normals; or gouraud, flat'
	@echo '                FPS=30          frames a second that the cycle budget is checked for'
	@echo '                CLOCK_MHZ=200   clock of the hardware'
	@echo '                OUT=build/NAME  folder of the results; NAME is that of the scene (and technique)'
	@echo '                SPANS=FILE      run a span file (see model/spans.py) in place of a scene'
	@echo '                PRUNE=1         build without what the scene does not need; or PRUNE=SCENE:'
	@echo '                                without what that one does not need'
	@echo 'make prune    what SCENE needs of the pipeline, and why; SCENE=all: what that saves'
	@echo '                SCENE=all SEEDS=3   placements to try for the clock; 0: no clock'
	@echo '                SCENE=all GATES=1   count gate equivalents, too (see make synth)'
	@echo 'make prune-random SCENES=200 random scenes, each on the build pruned to it (minutes)'
	@echo 'make check    lint and the fast tests: a minute'
	@echo 'make test     lint, then all tests of the main installation'
	@echo 'make lint     Verilator -Wall and Verible on rtl/ and sim/, Ruff on Python'
	@echo 'make results  the README'"'"'s table of results, measured anew'
	@echo 'make report   one page of all results: build/report/index.html'
	@echo 'make test-report  the page in headless Chromium: what it draws, its controls'
	@echo 'make test-all  make test and make test-report in one'
	@echo 'make stability  stiff and extreme cases, a row each: error, bound, RTL against model'
	@echo 'make adversarial  search for the input with the largest error; KEEP=1 keeps a worse one'
	@echo 'make bench    clocks a second of the simulation, frames a second of the model'
	@echo 'make synth    synthesis, place and route for an ECP5; build/synth/CONFIG/report.json'
	@echo '                CONFIG=default  a configuration by name'
	@echo '                SCENE=torus     only what this scene needs of it (see make prune)'
	@echo '                GRADE=6         speed grade of the chip, 6 or 8'
	@echo '                SEEDS=3         how many placements to try; the median counts'
	@echo '                GATES=1         count gate equivalents in standard cells, too (minutes)'
	@echo 'make sweep    error against run time and hardware over word widths and methods; build/sweep/'
	@echo '                AREA=1          synthesize each configuration, too, for its size'
	@echo '                ROUTE=1         place and route each anew for its clock: 2 hours; or ROUTE=name,name;'
	@echo '                                else the clocks kept in tests/records/ count, while they hold'
	@echo 'make tessellation  error against true surfaces, from coarse to fine meshes; Mach bands,'
	@echo '                flicker, orientation; part of make sweep, a minute'
	@echo 'make netlist  whole frames through the netlist in ECP5 cells, against the model'
	@echo 'make coverage line, branch and toggle coverage of rtl/ by the module and frame tests'
	@echo 'make activity register toggles a pixel of every bundled scene'
	@echo 'make waves    MODULE=phong_pipeline: a waveform of a short run, grouped for GTKWave'
	@echo 'make icarus   the module tests once more in Icarus Verilog, with unknown values (minutes)'
	@echo 'make mutate   change each constant and operator of rtl/, run the module tests (an hour or two)'
	@echo '                FILES="a b"     of these modules only'
	@echo '                KIND=operator   or KIND=constant'
	@echo '                SAMPLE=20       so many at random'
	@echo '                AGAIN=1         not those that were killed before and did not change'
	@echo 'make hardware the README'"'"'s table of hardware, proofs and tests, from the last results'
	@echo 'make formal   prove flow control and the interpolators, and that broken designs fail (minutes)'
	@echo 'make setup    install the pinned packages into .venv; the other targets do this by themselves'
	@echo 'make clean    remove build/ (.venv stays)'

setup:
	@scripts/setup.sh

run: setup
	@$(PYTHON) -m phong75.scripts.run --scene=$(call quote,$(SCENE)) --size=$(call quote,$(SIZE)) \
	  --fps=$(call quote,$(FPS)) --clock-mhz=$(call quote,$(CLOCK_MHZ)) \
	  --out=$(call quote,$(OUT)) --spans=$(call quote,$(SPANS)) \
	  --technique=$(call quote,$(TECHNIQUE)) \
	  --prune=$(call quote,$(PRUNE))

prune: setup
	@$(PYTHON) -m phong75.scripts.prune --scene=$(call quote,$(SCENE)) --size=$(call quote,$(SIZE)) \
	  --seeds=$(call quote,$(SEEDS)) --gates=$(call quote,$(GATES))

.PHONY: prune-random
SCENES ?= 200

prune-random: setup
	@$(PYTHON) -m tests.campaigns.random_scenes $(call quote,$(SCENES))

check: setup
	@$(PYTHON) -m tests.run check

test: setup
	@$(PYTHON) -m tests.run test

lint: setup
	@$(PYTHON) -m phong75.scripts.lint

bench: setup
	@$(PYTHON) -m phong75.scripts.benchmark

.PHONY: report test-report test-all stability adversarial
report: setup
	@$(PYTHON) -m phong75.scripts.page.report

test-report: setup
	@command -v chromium >/dev/null || \
	  { echo 'The report page is tested in Chromium: apt-get install chromium' >&2; exit 2; }
	@$(PYTHON) -m pytest tests/page

test-all: setup
	@$(PYTHON) -m tests.run all

stability: setup
	@$(PYTHON) -m phong75.scripts.stability

adversarial: setup
	@$(PYTHON) -m phong75.scripts.adversarial $(if $(KEEP),--keep)

results: setup
	@$(PYTHON) -m phong75.scripts.scene_results

sweep: setup
	@$(PYTHON) -m phong75.scripts.studies.sweep --area=$(call quote,$(AREA)) --route=$(call quote,$(ROUTE))
	@$(PYTHON) -m phong75.scripts.studies.tessellation_runs

tessellation: setup
	@$(PYTHON) -m phong75.scripts.studies.tessellation_runs

synth: setup
	@$(PYTHON) -m phong75.scripts.synth --config=$(call quote,$(CONFIG)) \
	  $(if $(filter-out file,$(origin SCENE)),--scene=$(call quote,$(SCENE))) --grade=$(call quote,$(GRADE)) \
	  --seeds=$(call quote,$(SEEDS)) --gates=$(call quote,$(GATES))

netlist: setup
	@$(PYTHON) -m phong75.scripts.netlist

coverage: setup
	@$(PYTHON) -m tests.campaigns.coverage

activity: setup
	@$(PYTHON) -m phong75.scripts.activity

waves: setup
	@$(PYTHON) -m phong75.scripts.waves $(call quote,$(MODULE))

mutate: setup
	@$(PYTHON) -m tests.campaigns.mutation $(if $(FILES),--files $(FILES)) $(if $(KIND),--kind $(KIND)) \
	  $(if $(SAMPLE),--sample $(SAMPLE)) $(if $(AGAIN),--again)

icarus: setup
	@$(PYTHON) -m tests.campaigns.icarus

hardware: setup
	@$(PYTHON) -m phong75.scripts.recorded

formal: setup
	@$(PYTHON) -m phong75.scripts.formal

clean:
	@rm -rf build .hypothesis .ruff_cache
	@find . -name __pycache__ -not -path './.venv/*' -prune -exec rm -rf {} +
