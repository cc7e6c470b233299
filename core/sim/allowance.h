#pragma once

#include <string_view>

#include "core/sim/setup.h"

namespace core {

struct Pair;

/// What a pair must keep: a distance, and how much overlap is contact when the distance is 0.
struct Allowance {
    double distance = 0.0;
    double contact = 0.0;
};

/// What a pair must keep, by the set-up's rules or else by default.
Allowance allowance_of(const Setup& setup, const Pair& pair);

/// How far away bodies are to be looked for: as far as the set-up says, and beyond its largest
/// allowance.
double search_limit_of(const Setup& setup);

/// Whether a name stands for a kind of bodies in allowances: flutes, shank, holder, nose, stock,
/// fixture, machine.
bool names_a_kind(std::string_view name);

} // namespace core
