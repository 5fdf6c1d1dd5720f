// Simulation program: cocotb on Verilator, with a fast way through long runs.
//
// While the top level's output `running` is 1, this loop toggles `clk` itself, without asking
// cocotb, so that whole frames run at the speed of a bare C++ loop. Otherwise cocotb is in charge
// as with its own main program. Time stands still meanwhile. A trace turns the fast way off.
//
// Options: --trace FILE   write a VCD (in builds with a trace)
//          --bare WRITES  no cocotb at all (for `make bench`): do the register writes in the file
//                         WRITES (address and word in hexadecimal, one a line), then one job

#include <chrono>
#include <cinttypes>
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

template <class Top>
static void clock(Top &top) {
    top.clk = 0;
    top.eval();
    top.clk = 1;
    top.eval();
}

// Whether the design asks for the fast way; designs without the output never do.
template <class Top>
static bool running(const Top &top) {
    if constexpr (requires { top.running; }) {
        return top.running && top.clk;
    } else {
        return false;
    }
}

// Clock the design until it stops running. Enters and leaves with clk = 1.
template <class Top>
static void run_fast(Top &top) {
    const auto begin = std::chrono::steady_clock::now();
    uint64_t clocks = 0;
    do {
        clock(top);
        ++clocks;
    } while (running(top) && !Verilated::gotFinish());
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    std::printf("clocks %" PRIu64 " seconds %.6f\n", clocks, seconds.count());
}

// Without cocotb: registers, one job, no callbacks.
template <class Top>
static int run_bare(Top &top, const char *writes) {
    if constexpr (requires { top.autostart; }) {
        std::FILE *file = std::fopen(writes, "r");
        if (!file) return 2;
        top.reset = 1;
        clock(top);
        top.reset = 0;
        uint64_t address, word;
        top.write_enable = 1;
        while (std::fscanf(file, "%" SCNx64 " %" SCNx64, &address, &word) == 2) {
            top.write_address = address;
            top.write_word = word;
            clock(top);
        }
        std::fclose(file);
        top.write_enable = 0;
        top.autostart = 1;
        clock(top);
        top.autostart = 0;
        run_fast(top);
        top.final();
        return top.complete ? 0 : 1;
    } else {
        return 2;  // not a bench of frames
    }
}

static void value_callbacks() {
    while (VerilatedVpi::callValueCbs()) {
    }
}

// One time step, as cocotb's own main program does it.
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

static void run_cocotb(Vtop &top, const char *trace_file) {
#if VM_TRACE
    VerilatedVcdC trace;
    Verilated::traceEverOn(true);
    if (trace_file) {
        top.trace(&trace, 99);
        trace.open(trace_file);
    }
#endif
    vlog_startup_routines_bootstrap();
    VerilatedVpi::callCbs(cbStartOfSimulation);
    value_callbacks();
    while (!Verilated::gotFinish()) {
        settle(top);
#if VM_TRACE
        if (trace_file) trace.dump(top.contextp()->time());
#endif
        if (running(top) && !trace_file) {
            run_fast(top);
            settle(top);
        }
        const uint64_t next = VerilatedVpi::cbNextDeadline();
        if (next == ~uint64_t{0}) break;  // nobody waits for anything
        top.contextp()->time(next);
        VerilatedVpi::callCbs(cbNextSimTime);
        value_callbacks();
        VerilatedVpi::callTimedCbs();
        value_callbacks();
    }
    top.final();
    VerilatedVpi::callCbs(cbEndOfSimulation);
#if VM_TRACE
    if (trace_file) trace.close();
#endif
}

int main(int argc, char **argv) {
    const char *writes = nullptr;
    const char *trace_file = nullptr;
    for (int i = 1; i + 1 < argc; ++i) {
        if (!std::strcmp(argv[i], "--bare")) writes = argv[++i];
        else if (!std::strcmp(argv[i], "--trace")) trace_file = argv[++i];
    }
    Verilated::commandArgs(argc, argv);
    Verilated::fatalOnVpiError(false);
    const std::unique_ptr<Vtop> top(new Vtop(""));
    if (writes) return run_bare(*top, writes);
    run_cocotb(*top, trace_file);
    return Verilated::threadContextp()->errorCount() > 0 ? 1 : 0;
}
