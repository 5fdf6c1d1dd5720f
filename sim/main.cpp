// SPDX-License-Identifier: MIT
// Simulation program: cocotb on Verilator, with a fast loop for long runs.
//
// While the top level's output `running` is 1, this program toggles `clk` in its own loop without
// calling cocotb, so that whole frames run at the speed of a bare C++ loop. Simulation time stands
// still meanwhile. Otherwise the program does what cocotb's own main program does. With a trace the
// fast loop is off.
//
// Options: --trace FILE   write a VCD (in builds with a trace)
//          --bare FILE    run without cocotb (for `make bench`); see run_bare

#include <chrono>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include "Vtop.h"
#include "verilated.h"
#include "verilated_vpi.h"
#if VM_COVERAGE
#include "verilated_cov.h"
#endif
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

// Whether the design asks for the fast loop. A top level without the output `running` never does.
template <class Top>
static bool running(const Top &top) {
    if constexpr (requires { top.running; }) {
        return top.running && top.clk;
    } else {
        return false;
    }
}

// Clock the design until its output `running` is 0. `clk` is 1 before and after.
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

// The bare loop: feed phong_pipeline from memory, take its pixels and add them up, without files
// and without cocotb.
// FILE holds 32-bit words: the number of register writes; address, low word and high word of each;
// the number of spans, the words per span, the bit of `last` in a span, the number of pixels; then
// the spans.
template <class Top>
static int run_bare(Top &top, const char *name) {
    if constexpr (requires { top.s_axis_tdata; }) {
        std::vector<uint32_t> data;
        std::FILE *file = std::fopen(name, "rb");
        if (!file) return 2;
        for (uint32_t word; std::fread(&word, sizeof word, 1, file) == 1;) data.push_back(word);
        std::fclose(file);
        const uint32_t *next = data.data();
        top.s_axis_tvalid = 0;
        top.m_axis_tready = 1;
        top.reset = 1;
        clock(top);
        clock(top);
        top.reset = 0;
        top.write_enable = 1;
        for (uint32_t writes = *next++; writes; --writes, next += 3) {
            top.write_address = next[0];
            top.write_word = next[1] | uint64_t{next[2]} << 32;
            clock(top);
        }
        top.write_enable = 0;
        clock(top);
        uint32_t spans = next[0];
        const uint32_t words = next[1], last_bit = next[2], pixels = next[3];
        next += 4;
        uint64_t clocks = 0, sum = 0;
        const auto begin = std::chrono::steady_clock::now();
        for (uint32_t count = 0; count < pixels; ++clocks) {
            top.s_axis_tvalid = spans != 0;
            if (spans) {
                std::memcpy(&top.s_axis_tdata, next, sizeof top.s_axis_tdata);
                top.s_axis_tlast = next[last_bit / 32] >> last_bit % 32 & 1;
            }
            top.clk = 0;
            top.eval();
            const bool taken = top.s_axis_tvalid && top.s_axis_tready;
            if (top.m_axis_tvalid) {
                sum += top.m_axis_tdata;
                ++count;
            }
            top.clk = 1;
            top.eval();
            if (taken) {
                next += words;
                --spans;
            }
        }
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
        std::printf("clocks %" PRIu64 " seconds %.6f sum %" PRIu64 "\n", clocks, seconds.count(),
                    sum);
        top.final();
        return 0;
    } else {
        return 2;  // the top level is not phong_pipeline
    }
}

static void value_callbacks() {
    while (VerilatedVpi::callValueCbs()) {
    }
}

// One time step, as in cocotb's own main program.
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
        if (next == ~uint64_t{0}) break;  // no callback is pending
        top.contextp()->time(next);
        VerilatedVpi::callCbs(cbNextSimTime);
        value_callbacks();
        VerilatedVpi::callTimedCbs();
        value_callbacks();
    }
    top.final();
    VerilatedVpi::callCbs(cbEndOfSimulation);
#if VM_COVERAGE
    top.contextp()->coveragep()->write();  // to +verilator+coverage+file+
#endif
#if VM_TRACE
    if (trace_file) trace.close();
#endif
}

int main(int argc, char **argv) {
    const char *bare_file = nullptr;
    const char *trace_file = nullptr;
    for (int i = 1; i + 1 < argc; ++i) {
        if (!std::strcmp(argv[i], "--bare")) bare_file = argv[++i];
        else if (!std::strcmp(argv[i], "--trace")) trace_file = argv[++i];
    }
    Verilated::commandArgs(argc, argv);
    Verilated::fatalOnVpiError(false);
    const std::unique_ptr<Vtop> top(new Vtop(""));
    if (bare_file) return run_bare(*top, bare_file);
    run_cocotb(*top, trace_file);
    return Verilated::threadContextp()->errorCount() > 0 ? 1 : 0;
}
