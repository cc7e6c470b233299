#pragma once

#include <fmt/format.h>

#include "app/library/result/batch_result.h"

namespace test_support {

/// One of many program results, with its own texts and numbers, and a number of findings.
inline app::ProgramResult one_of_many(size_t i, size_t findings) {
    using core::Severity;
    constexpr core::Verdict verdicts[] = {core::Verdict::clear, core::Verdict::undecided,
                                          core::Verdict::violation, core::Verdict::collision};
    app::ProgramResult program{.program = fmt::format("parts/order {}/part {}.nc", i % 97, i),
                               .setup = fmt::format("parts/setups/vise {}.toml", i % 40),
                               .sha256 = fmt::format("{:064x}", i * 7919),
                               .dialect = i % 2 == 0 ? "fanuc" : "heidenhain",
                               .engine = "exact",
                               .verdict = verdicts[i % 4],
                               .coverage = app::Coverage{.stock = app::Known::described,
                                                         .fixtures = app::Known::described,
                                                         .offsets = app::Known::described,
                                                         .limits = app::Known::described,
                                                         .moves = true},
                               .blocks = 10 + i * 31 % 4000,
                               .cycle_time = 0.7 * static_cast<double>(i % 900),
                               .removed = 11.3 * static_cast<double>(i % 700),
                               .seconds = 0.01 * static_cast<double>(i % 300)};
    for (size_t k = 0; k < findings; ++k) {
        const auto line = static_cast<uint32_t>(5 + 3 * k);
        program.findings.push_back(
            {{.rule = k % 3 == 0   ? "near-miss"
                      : k % 3 == 1 ? "rapid-near-clamp"
                                   : "air-cut",
              .severity = static_cast<Severity>(1 + (i + k) % 3),
              .block = core::BlockIndex{line},
              .message = fmt::format("The holder comes within {:.3f} mm of clamp-{} in part {}.",
                                     0.001 * static_cast<double>((i * 13 + k) % 2000), k % 4, i),
              .cure = "Retract above the fixture before going across.",
              .pair = {"holder", fmt::format("clamp-{}", k % 4)},
              .shortfall = 0.5},
             line,
             "",
             fmt::format("N{} G0 X{:.3f} Y{}.", line, 0.013 * static_cast<double>(i), k)});
    }
    program.assumptions = {
        "rapids run straight",
        fmt::format("the stock is the box that cutting moves reach: X 0 to {}", i)};
    program.tightest = app::Tightest{.block = 5,
                                     .line = 5,
                                     .pair = {"holder", "clamp-1"},
                                     .lower = 0.0007 * static_cast<double>(i % 9000),
                                     .upper = {},
                                     .allowance = 2.0};
    if (i % 50 == 0) program.error = app::StoredError{program.program, 7, 3, "G999: no such code"};
    return program;
}

/// A batch with a number of programs and findings in each.
inline app::BatchResult large_batch(size_t programs, size_t findings) {
    app::BatchResult batch;
    for (size_t i = 0; i < programs; ++i) batch.programs.push_back(one_of_many(i, findings));
    return batch;
}

} // namespace test_support
