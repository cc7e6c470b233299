#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace core {

/// What is known of a pair of bodies over a block, from harmless to worst.
enum class Verdict : uint8_t { clear, undecided, violation, collision };

const char* name_of(Verdict verdict);

/// What a block moves, as reports show it.
enum class BlockMotion : uint8_t { none, rapid, feed, arc, cycle };

const char* name_of(BlockMotion motion);

/// Which clearances of a block a check reports: those of every pair of bodies; that of the deciding
/// pair; or none where a bound already clears the block.
enum class Detail : uint8_t { every_pair, deciding_pair, verdict };

/// Lengths nearer together than this are the same length, mm: an allowance that is kept to within
/// it counts as kept. It stands far above rounding and far below anything a machine can hold.
constexpr double resolution = 1e-6;

/// The whole units of the last of so many decimals that a number certainly holds. What lies below
/// a unit by half a thousandth of it, or by half of `resolution`, is that unit: rounding must not
/// turn 2 into 1.999. Two numbers that differ by more than `resolution`, the lower one as units
/// below and the higher one as units above, never become the same.
double units_below(double value, int digits);

/// The whole units that are certainly no less, in the same way.
double units_above(double value, int digits);

/// A lower bound as "1.999": never more than it is.
std::string at_least(double lower, int digits = 3);

/// An upper bound, or what must be kept, as "2.001": never less than it is.
std::string at_most(double upper, int digits = 3);

/// The same with so many figures, without zeros behind the last one that counts: "0.016".
std::string at_most_figures(double upper, int figures);

/// A lower bound of a clearance, which is never below 0.
std::string clearance_at_least(double lower, int digits = 3);

/// Decimals of an upper bound: so many that what is too near is not printed as what must be kept.
int digits_below(double upper, double keep);

/// The bounds of a clearance as "1.999" where they are a last digit apart at most, else both, as
/// "1.999 to 2.003".
std::string bounds_text(double lower, double upper, std::string_view between, int digits = 3);

/// The bounds of what is missing in the same way, but the larger one where one says both.
std::string missing_text(double least, double most, std::string_view between, int digits = 3);

/// The bounds of a clearance with three decimals, and as many as it takes for an upper bound below
/// what must be kept: "1.900-1.999600" where that is 2.
std::string bounds_below(double lower, double upper, double keep, std::string_view between);

} // namespace core
