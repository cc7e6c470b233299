#include "app/coproc/study/coprocessor_report.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/base/text.h"
#include "app/coproc/device_judge.h"

namespace app {
namespace {

std::optional<double> fraction(uint64_t part, uint64_t whole) {
    if (whole == 0) return {};
    return static_cast<double>(part) / static_cast<double>(whole);
}

} // namespace

CoprocessorResult in_time(CoprocessorRun run, const DeviceFile& file, bool past_refusals) {
    CoprocessorResult result;
    result.timing =
        timed_with_permits(run.plan, services_of(run, file.device.clock_mhz, file.control),
                           file.control, past_refusals);
    result.fits = least_clocks(run, file.control);
    result.file = file;
    result.run = std::move(run);
    return result;
}

DeviceUse use_between(const DeviceTotals& before, const DeviceTotals& after,
                      const hwsim::DeviceConfig& device) {
    using hwsim::Counter;
    const auto counted = [&](Counter counter) { return after[counter] - before[counter]; };
    const uint64_t threads = counted(Counter::busy) * device.threads;
    const auto hits = [&](Counter hit, Counter miss) {
        return fraction(counted(hit), counted(hit) + counted(miss));
    };
    return {
        fraction(counted(Counter::busy), counted(Counter::cycles) * device.elements).value_or(0.0),
        fraction(counted(Counter::wait_memory), threads).value_or(0.0),
        fraction(counted(Counter::wait_port), threads).value_or(0.0),
        fraction(counted(Counter::wait_retire), threads).value_or(0.0),
        hits(Counter::node_hits, Counter::node_misses),
        hits(Counter::record_hits, Counter::record_misses)};
}

namespace {

using hwsim::Counter;
using Json = nlohmann::ordered_json;

constexpr std::array<const char*, hwsim::counter_count> counter_names = {
    "cycles",        "busy",        "queries",     "nodes",       "splits",        "box_tests",
    "pair_tests",    "node_hits",   "node_misses", "record_hits", "record_misses", "lines_read",
    "lines_written", "wait_memory", "wait_port",   "wait_retire", "missed",        "deepest",
    "least_slack",   "longest",     "host_lines"};

/// Latencies of the blocks with questions, sorted, s.
std::vector<double> latencies(const CoprocessorResult& result) {
    std::vector<double> seconds;
    for (const DeviceBlock& block : result.run.blocks)
        if (block.permit.segments > 0)
            seconds.push_back(static_cast<double>(block.cycles)
                              / (1e6 * result.file.device.clock_mhz));
    std::sort(seconds.begin(), seconds.end());
    return seconds;
}

double joules(const CoprocessorResult& result, double working) {
    const DeviceTotals& totals = result.run.totals;
    const EnergyTable& energy = result.file.energy;
    const auto part = [&](double picojoules, uint64_t count) {
        return 1e-12 * picojoules * static_cast<double>(count);
    };
    const uint64_t cached = totals[Counter::node_hits] + totals[Counter::record_hits];
    const uint64_t moved = totals[Counter::lines_read] + totals[Counter::lines_written];
    return part(energy.box_test, totals[Counter::box_tests])
           + part(energy.pair_test, totals[Counter::pair_tests]) + part(energy.cache_line, cached)
           + part(energy.memory_line, moved) + energy.idle_watts * working;
}

std::string block_text(const CoprocessorResult& result, size_t block) {
    return fmt::format("block {}, line {}", block, result.run.check.blocks[block].line);
}

std::string verdict_text(const CoprocessorResult& result) {
    const auto& blocks = result.run.blocks;
    const auto refused = static_cast<size_t>(std::count_if(
        blocks.begin(), blocks.end(), [](const auto& b) { return !b.permit.permitted; }));
    if (refused == 0) return "every block is permitted";
    const auto first =
        static_cast<size_t>(std::find_if(blocks.begin(), blocks.end(),
                                         [](const auto& b) { return !b.permit.permitted; })
                            - blocks.begin());
    std::string text = fmt::format("refuses {} of {} blocks, first {}: {}", refused, blocks.size(),
                                   block_text(result, first), refusal(result, first));
    if (result.timing.refused) text += "; the machine stops before it";
    return text;
}

std::string slack_text(const CoprocessorResult& result) {
    const PermitTiming& timing = result.timing;
    if (!timing.tightest) return "no block needs a permit in time";
    const std::string least =
        fmt::format("least slack {}, {}", time_text(timing.blocks[*timing.tightest].slack()),
                    block_text(result, *timing.tightest));
    if (timing.missed == 0) return "yes; " + least;
    return fmt::format("no: {} permits were late; {}", timing.missed, least);
}

Json config_json(const CoprocessorResult& result) {
    const hwsim::DeviceConfig& d = result.file.device;
    const ControlConfig& c = result.file.control;
    return {{"device",
             {{"clock_mhz", d.clock_mhz},
              {"elements", d.elements},
              {"threads", d.threads},
              {"volumes", name_of(d.volumes)},
              {"stack_depth", d.stack_depth},
              {"node_cache_lines", d.node_cache_lines},
              {"record_cache_lines", d.record_cache_lines},
              {"fifo_depth", d.fifo_depth},
              {"memory_lines", d.memory_lines},
              {"memory_latency", d.memory_latency},
              {"cycles_per_line", d.cycles_per_line},
              {"host_latency", d.host_latency},
              {"host_cycles_per_line", d.host_cycles_per_line}}},
            {"control",
             {{"servo_period", c.servo.period},
              {"io_latency", c.servo.latency},
              {"feed_override", c.servo.feed},
              {"look_ahead", c.look_ahead},
              {"line_time_us", 1e6 * c.line_time}}}};
}

/// A finite time, else null.
Json known(double seconds) { return std::isfinite(seconds) ? Json(seconds) : Json(nullptr); }

Json block_json(const CoprocessorResult& result, size_t i) {
    const DeviceBlock& block = result.run.blocks[i];
    const BlockTiming& timing = result.timing.blocks[i];
    return {{"block", i},
            {"line", result.run.check.blocks[i].line},
            {"segments", block.permit.segments},
            {"cycles", block.cycles},
            {"nodes", block.nodes},
            {"pairs", block.pairs},
            {"lines", block.lines},
            {"asked", known(timing.asked)},
            {"permitted", known(block.permit.permitted ? timing.permitted : core::infinity)},
            {"due", known(timing.due)},
            {"entered", known(timing.entered)},
            {"slack", known(timing.slack())},
            {"refused", block.permit.permitted ? Json(nullptr) : Json(refusal(result, i))},
            {"verdict", core::name_of(result.run.check.blocks[i].result.verdict)},
            {"interval", block.interval}};
}

} // namespace

std::string refusal(const CoprocessorResult& result, size_t block) {
    const BlockPermit& permit = result.run.blocks[block].permit;
    if (!permit.not_queried.empty()) return permit.not_queried;
    if (permit.stop == hwsim::Stop::none && !permit.doubt.empty()) return permit.doubt;
    const std::string why = hwsim::name_of(permit.stop);
    if (!permit.pair) return why;
    const std::string pair =
        fmt::format("{} / {}", core::part_name(result.run.check.setup, *permit.pair),
                    core::body_name(result.run.check.setup, *permit.pair));
    return permit.stop == hwsim::Stop::violation ? pair : why + ": " + pair;
}

std::string time_text(double seconds) {
    const double size = std::abs(seconds);
    if (size < 1e-3) return fmt::format("{:.1f} us", 1e6 * seconds);
    if (size < 1.0) return fmt::format("{:.1f} ms", 1e3 * seconds);
    if (size < 120.0) return fmt::format("{:.2f} s", seconds);
    return (seconds < 0.0 ? "-" : "") + duration_text(size);
}

std::string fit_text(const std::vector<DeviceFit>& fits) {
    if (fits.empty()) return "not searched";
    const auto best = smallest(fits);
    if (!best)
        return fmt::format("none of {} elements at up to {} MHz", fits.back().elements,
                           clocks.back());
    return fmt::format("{} {} at {} MHz would have met every deadline", best->elements,
                       best->elements == 1 ? "element" : "elements", *best->clock_mhz);
}

EngineAgreement agreement(const CoprocessorRun& run) {
    EngineAgreement found;
    for (size_t i = 0; i < run.blocks.size(); ++i)
        add(found, run.blocks[i].permit, run.check.blocks[i].result);
    return found;
}

DeviceFigures figures(const CoprocessorResult& result) {
    const DeviceTotals& totals = result.run.totals;
    DeviceFigures f;
    const std::vector<double> sorted = latencies(result);
    const double working = std::accumulate(sorted.begin(), sorted.end(), 0.0);
    if (!sorted.empty()) {
        const auto at = [&](double part) {
            const double rank = std::ceil(part * static_cast<double>(sorted.size()));
            return sorted[static_cast<size_t>(std::max(rank, 1.0)) - 1];
        };
        f.p50 = at(0.5);
        f.p99 = at(0.99);
        f.longest = sorted.back();
    }
    if (result.timing.taken > 0.0) f.busy_fraction = result.timing.busy / result.timing.taken;
    if (working > 0.0) {
        f.queries_per_second = static_cast<double>(totals[Counter::queries]) / working;
        f.bytes_per_second = 64.0 * static_cast<double>(totals[Counter::lines_read]) / working;
    }
    const DeviceUse fractions = use_between({}, totals, result.file.device);
    f.memory_stall = fractions.memory;
    f.port_stall = fractions.ports;
    f.order_stall = fractions.order;
    f.node_hits = fractions.node_hits.value_or(0.0);
    f.record_hits = fractions.record_hits.value_or(0.0);
    f.joules = joules(result, working);
    for (const DeviceBlock& block : result.run.blocks) f.lines_made += block.lines;
    if (result.timing.taken > 0.0) f.control_share = result.timing.making / result.timing.taken;
    return f;
}

std::string coprocessor_text(const CoprocessorResult& result) {
    const hwsim::DeviceConfig& device = result.file.device;
    const DeviceTotals& totals = result.run.totals;
    const DeviceFigures f = figures(result);
    const EngineAgreement both = agreement(result.run);
    std::string text = fmt::format("{}: with a coprocessor, {} elements of {} threads, {} MHz\n",
                                   trimmed(result.run.check.program_file), device.elements,
                                   device.threads, device.clock_mhz);
    const auto add = [&](const std::string& heading, const std::string& words) {
        const std::string head = fmt::format("  {:<11}", heading);
        text += head + wrapped(words, head.size()).substr(head.size());
    };
    add("permits", verdict_text(result));
    add("kept up", slack_text(result));
    add("time", fmt::format("{} planned, {} {}", time_text(result.timing.planned),
                            result.timing.refused ? "stops after" : "takes",
                            time_text(result.timing.taken)));
    add("work",
        fmt::format("{} blocks, {} queries, {} nodes, {} pairs, {} cycles",
                    result.run.blocks.size(), totals[Counter::queries], totals[Counter::nodes],
                    totals[Counter::pair_tests], totals[Counter::cycles]));
    add("control",
        fmt::format("makes {} lines for the coprocessor in {}: {:.3g} % of the time", f.lines_made,
                    time_text(result.timing.making), 100.0 * f.control_share));
    add("latency", fmt::format("median {}, 99th percentile {}, maximum {}", time_text(f.p50),
                               time_text(f.p99), time_text(f.longest)));
    add("rate", fmt::format("{:.0f} queries per second while busy; busy {:.3g} % of the time",
                            f.queries_per_second, 100.0 * f.busy_fraction));
    add("stalls", fmt::format("memory {:.0f} %, ports {:.0f} %, order {:.0f} % of busy threads",
                              100.0 * f.memory_stall, 100.0 * f.port_stall, 100.0 * f.order_stall));
    add("caches",
        fmt::format("nodes {:.0f} %, records {:.0f} % hits; {:.1f} MB per second from "
                    "memory while busy",
                    100.0 * f.node_hits, 100.0 * f.record_hits, f.bytes_per_second / 1e6));
    add("energy", fmt::format("{:.3g} J while busy (estimate)", f.joules));
    add("smallest", fit_text(result.fits));
    add("engines",
        fmt::format("exact engine: {}; coprocessor: permits {} of its violations and {} of its "
                    "undecided blocks, refuses {} of its clear blocks, cannot check {}",
                    core::name_of(result.run.check.verdict), both.missed, both.unproven,
                    both.false_alarms, both.not_queried));
    return printable(text);
}

std::string coprocessor_json(const CoprocessorResult& result) {
    const DeviceFigures f = figures(result);
    const EngineAgreement both = agreement(result.run);
    Json counters = Json::object();
    for (size_t i = 0; i < counter_names.size(); ++i)
        counters[counter_names[i]] = result.run.totals.counters[i];
    // The times of the machine are not those of the device, so no deadlines are set in it.
    counters["least_slack"] = nullptr;
    Json fits = Json::array();
    for (const DeviceFit& fit : result.fits)
        fits.push_back({{"elements", fit.elements},
                        {"clock_mhz", fit.clock_mhz ? Json(*fit.clock_mhz) : Json(nullptr)}});
    const PermitTiming& timing = result.timing;
    Json report = {
        {"format", "feeler-coprocessor"},
        {"version", 1},
        {"program", result.run.check.program_file},
        {"config", config_json(result)},
        {"totals",
         {{"blocks", result.run.blocks.size()},
          {"planned", timing.planned},
          {"taken", timing.taken},
          {"waited", std::max(0.0, timing.taken - timing.planned)},
          {"missed", timing.missed},
          {"kept_up", timing.missed == 0},
          {"stands_before", timing.refused ? Json(*timing.refused) : Json(nullptr)},
          {"least_slack",
           timing.tightest ? Json(timing.blocks[*timing.tightest].slack()) : Json(nullptr)},
          {"tightest", timing.tightest ? Json(*timing.tightest) : Json(nullptr)},
          {"busy_share", f.busy_fraction},
          {"control_seconds", timing.making},
          {"control_share", f.control_share},
          {"queries_per_second", f.queries_per_second},
          {"latency", {{"p50", f.p50}, {"p99", f.p99}, {"max", f.longest}}},
          {"stalls",
           {{"memory", f.memory_stall}, {"ports", f.port_stall}, {"order", f.order_stall}}},
          {"hits", {{"nodes", f.node_hits}, {"records", f.record_hits}}},
          {"bytes_per_second", f.bytes_per_second},
          {"joules_estimated", f.joules},
          {"engine",
           {{"verdict", core::name_of(result.run.check.verdict)},
            {"missed", both.missed},
            {"undecided_permitted", both.unproven},
            {"false_alarms", both.false_alarms},
            {"not_asked", both.not_queried}}}}},
        {"fits", fits},
        {"counters", counters},
        {"blocks", Json::array()}};
    for (size_t i = 0; i < result.run.blocks.size(); ++i)
        report["blocks"].push_back(block_json(result, i));
    return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string coprocessor_csv(const CoprocessorResult& result) {
    std::string text = "block,line,segments,cycles,nodes,pairs,asked,permitted,due,entered,slack,"
                       "refused,verdict,interval\r\n";
    for (size_t i = 0; i < result.run.blocks.size(); ++i) {
        std::string row;
        const Json block = block_json(result, i);
        for (const auto& [key, value] : block.items()) {
            const std::string cell = value.is_null() ? ""
                                     : value.is_number_float()
                                         ? fmt::format("{:.9f}", value.get<double>())
                                     : value.is_string() ? csv_cell(value.get<std::string>())
                                                         : value.dump();
            row += (row.empty() ? "" : ",") + cell;
        }
        text += row + "\r\n";
    }
    return text;
}

} // namespace app
