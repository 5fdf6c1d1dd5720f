// Simulation program: cocotb on Verilator, with a fast way through long runs.
//
// While the top level's output `running` is 1, this loop toggles `clk` itself, without asking
// cocotb, so that whole frames run at the speed of a bare C++ loop. Otherwise cocotb is in charge
// as with its own main program. Time stands still meanwhile. A trace turns the fast way off.
//
// Options: --bare        no cocotb at all: start, run while `running`, report (for `make bench`)
//          --trace FILE  write a VCD (in builds with a trace)

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>

#include "Vtop.h"
#include "verilated.h"
#include "verilated_vpi.h"
#if VM_TRACE
#include "verilated_vcd_c.h"
#endif

extern "C" void vlog_startup_routines_bootstrap(void);

static uint64_t fast_clocks = 0;
static double fast_seconds = 0;

// Clock the design until it stops running. Enters and leaves with clk = 1.
static void run_fast(Vtop &top) {
    const auto begin = std::chrono::steady_clock::now();
    uint64_t clocks = 0;
    do {
        top.clk = 0;
        top.eval();
        top.clk = 1;
        top.eval();
        ++clocks;
    } while (top.running && !Verilated::gotFinish());
    fast_clocks += clocks;
    fast_seconds +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

static void value_callbacks() {
    while (VerilatedVpi::callValueCbs()) {
    }
}

static void settle(Vtop &top) {
    do {
        do {
            top.eval_step();
            VerilatedVpi::clearEvalNeeded();
            VerilatedVpi::doInertialPuts();
            value_callbacks();
        } while (VerilatedVpi::evalNeeded());
        VerilatedVpi::callCbs(cbReadWriteSynch);
        VerilatedVpi::doInertialPuts();
        value_callbacks();
    } while (VerilatedVpi::evalNeeded());
    top.eval_end_step();
    VerilatedVpi::callCbs(cbReadOnlySynch);
}

static int run_bare(Vtop &top) {
    for (top.autostart = 1; !top.running;) {
        top.clk = 0;
        top.eval();
        top.clk = 1;
        top.eval();
    }
    run_fast(top);
    top.final();
    return 0;
}

int main(int argc, char **argv) {
    bool bare = false;
    const char *trace_file = nullptr;
    for (int i = 1; i < argc; ++i) {
        if (!std::strcmp(argv[i], "--bare")) bare = true;
        if (!std::strcmp(argv[i], "--trace") && i + 1 < argc) trace_file = argv[++i];
    }
    Verilated::commandArgs(argc, argv);
    Verilated::fatalOnVpiError(false);
    std::unique_ptr<Vtop> top(new Vtop(""));

    int status = 0;
    if (bare) {
        status = run_bare(*top);
    } else {
#if VM_TRACE
        VerilatedVcdC trace;
        Verilated::traceEverOn(true);
        if (trace_file) {
            top->trace(&trace, 99);
            trace.open(trace_file);
        }
#endif
        vlog_startup_routines_bootstrap();
        VerilatedVpi::callCbs(cbStartOfSimulation);
        value_callbacks();
        while (!Verilated::gotFinish()) {
            settle(*top);
#if VM_TRACE
            if (trace_file) trace.dump(top->contextp()->time());
#endif
            if (top->running && top->clk && !trace_file) {
                run_fast(*top);
                settle(*top);
            }
            const uint64_t next = VerilatedVpi::cbNextDeadline();
            if (next == ~uint64_t{0}) break;
            top->contextp()->time(next);
            VerilatedVpi::callCbs(cbNextSimTime);
            value_callbacks();
            VerilatedVpi::callTimedCbs();
            value_callbacks();
        }
        top->final();
        VerilatedVpi::callCbs(cbEndOfSimulation);
#if VM_TRACE
        if (trace_file) trace.close();
#endif
    }
    if (fast_clocks) {
        std::printf("clocks %llu seconds %.6f\n", static_cast<unsigned long long>(fast_clocks),
                    fast_seconds);
    }
    return Verilated::threadContextp()->errorCount() > 0 ? 1 : status;
}
