#pragma once

#include <functional>
#include <string>

#include "core/base/result.h"

namespace app {

struct CheckJob;

/// What a set-up sheet is wanted to have.
struct SheetWishes {
    bool tolerances = false, pictures = true;
    std::string program_date, check_date; // see SheetContent
    // Polled while tolerances are searched, from several threads; false: end the search.
    std::function<bool()> goes_on = [] { return true; };
};

/// A set-up sheet that was made.
struct MadeSheet {
    std::string html;
    bool has_errors = false;              // the check has
    bool tolerances_were_stopped = false; // `goes_on` has ended the search
};

/// Checks a program and makes its set-up sheet. Draws with OpenGL: a thread with a window of its
/// own must call this from another one.
///
/// Errors: those of run_check and tolerances_of; the error at which the program stopped, as it then
///         has no sheet; io, if the program was changed meanwhile.
/// Cost:   that of the check, one more reading of the program, and 0.5 s for pictures; with
///         tolerances, some hundred times the check, at most some ten to twenty minutes.
core::Result<MadeSheet> make_sheet(const CheckJob& job, const SheetWishes& wishes);

} // namespace app
