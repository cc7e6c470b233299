#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace core {

/// Verdict on a pair of bodies during a block, from best to worst.
enum class Verdict : uint8_t { clear, undecided, violation, collision };

inline constexpr std::array all_verdicts = {Verdict::clear, Verdict::undecided, Verdict::violation,
                                            Verdict::collision};

const char* name_of(Verdict verdict);

/// Kind of motion in a block, as reports show it.
enum class BlockMotion : uint8_t { none, rapid, feed, arc, cycle };

inline constexpr std::array all_block_motions = {
    BlockMotion::none, BlockMotion::rapid, BlockMotion::feed, BlockMotion::arc, BlockMotion::cycle};

const char* name_of(BlockMotion motion);

/// Which clearances of a block a check reports: those of every pair; that of the deciding pair; or
/// none if a bound already shows that the block is clear.
enum class Detail : uint8_t { every_pair, deciding_pair, verdict };

/// Lengths that differ by less than this are considered equal, mm: clearances are compared with
/// allowances to within it. It is far above rounding errors and far below the accuracy of any
/// machine.
constexpr double resolution = 1e-6;

/// `value` in units of its last decimal (of `digits`), rounded down. A value that is below a unit
/// by at most half a thousandth of it and at most half of `resolution` counts as that unit:
/// rounding must not turn 2 into 1.999. If two numbers differ by more than `resolution`,
/// units_below of the lower and units_above of the higher always differ.
double units_below(double value, int digits);

/// `value` in units of its last decimal, rounded up, with the same tolerance.
double units_above(double value, int digits);

/// Text of a lower bound, such as "1.999": rounded down.
std::string at_least(double lower, int digits = 3);

/// Text of an upper bound or a minimum clearance, such as "2.001": rounded up.
std::string at_most(double upper, int digits = 3);

/// Text of an upper bound with this many significant figures, without trailing zeros: "0.016".
std::string at_most_figures(double upper, int figures);

/// Text of a lower bound of a clearance, at least 0.
std::string clearance_at_least(double lower, int digits = 3);

/// Number of decimals for an upper bound, so that a clearance below the minimum `keep` is not
/// printed as equal to it.
int digits_below(double upper, double keep);

/// Text of the bounds of a clearance: "1.999" if they differ by at most one unit of the last digit,
/// else both, such as "1.999 to 2.003".
std::string bounds_text(double lower, double upper, std::string_view between, int digits = 3);

/// Text of the bounds of a shortfall, in the same way, but a single number is the larger bound.
std::string missing_text(double least, double most, std::string_view between, int digits = 3);

/// Text of the bounds of a clearance with three decimals, and more for an upper bound just below
/// the minimum `keep`: "1.900-1.999600" if that is 2.
std::string bounds_below(double lower, double upper, double keep, std::string_view between);

} // namespace core
