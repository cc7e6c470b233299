#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace test_support {

/// The results of many blocks: every violated claim, and statistics of the sample.
struct MachiningTally {
    size_t blocks = 0, pairs = 0, near = 0, overlaps = 0, witnesses = 0, contacts = 0;
    std::array<size_t, 4> verdicts{};
    size_t sharp = 0, fixture_pairs = 0; // intervals of at most 1e-3 mm; all pairs without rotation
    double widest = 0.0;                 // against fixtures, mm
    std::vector<double> stock_widths;    // over the mesh size
    size_t settled = 0;                  // stock pairs that are decided or narrower than 0.05 mm
    size_t cut_fixtures = 0; // blocks in which a fixture cut by the flutes is reported clear
    size_t standing = 0;     // points next to a cut, expected in the columns
    std::vector<std::string> failures;

    bool is_representative() const {
        return near > blocks / 20 && overlaps > blocks / 20 && witnesses > blocks / 2
               && std::min({verdicts[0], 20 * verdicts[2], verdicts[3]}) > blocks / 10;
    }
    std::string report() const;
};

/// How the bodies of a set-up are known: as they are, or as others that deviate from them.
enum class KnownBodies : uint8_t { exact, deviating };

/// The results of a number of programs with `blocks` blocks each, every one on its own set-up.
MachiningTally judged_programs(unsigned first_seed, unsigned programs, int blocks, bool turning,
                               KnownBodies bodies = KnownBodies::exact);

} // namespace test_support
