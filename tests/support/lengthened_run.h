#pragma once

#include <cmath>

#include <fmt/format.h>

#include "app/check/check_run.h"

namespace test_support {

/// A run with `count` blocks, made from blocks 8 to 29 of another one. Each block has its own text
/// and numbers.
inline app::CheckRun lengthened(app::CheckRun run, size_t count) {
    std::vector<app::CheckedBlock> blocks;
    for (size_t i = 8; i < 30; ++i) blocks.push_back(run.blocks[i]);
    run.blocks.truncate(0);
    for (size_t i = 0; i < count; ++i) {
        app::CheckedBlock block = blocks[i % blocks.size()];
        const auto step = static_cast<double>(i);
        block.block = core::BlockIndex{static_cast<uint32_t>(i)};
        block.line = static_cast<uint32_t>(i + 5);
        block.text =
            fmt::format("X{:.3f} Y{:.3f} Z{:.3f}", 0.0137 * step, 0.731 * step, -0.01 * step);
        block.result.time = 0.0421 * step;
        block.result.removed = std::fmod(0.37 * step, 11.0);
        for (core::PairClearance& pair : block.result.pairs) {
            pair.lower = std::fmod(0.0173 * step, 20.0);
            pair.upper = pair.lower + std::fmod(0.0031 * step, 0.2);
        }
        run.blocks.push_back(block);
    }
    for (core::Finding& finding : run.findings) finding.block = core::BlockIndex{7};
    return run;
}

} // namespace test_support
