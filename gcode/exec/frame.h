#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "gcode/language/modal_state.h"
#include "gcode/language/parameters.h"
#include "gcode/text/shared.h"

namespace gcode {

struct Dialect;
struct FlowIndex;
struct Frame;
struct InterpreterState;
class LanguageState;
struct Program;

/// The type of a variable that a program declares.
enum class VariableType : uint8_t { real, whole, truth, text };

/// The value of a variable that depends on what only the machine knows.
struct UnknownValue {
    std::vector<std::string> origins; // what it was computed from, as written; empty: it is known
    std::string identity;             // see Trace

    bool operator==(const UnknownValue&) const = default;
};

/// By the names of the variables as written.
using UnknownValues = std::map<std::string, UnknownValue, std::less<>>;

/// The local variables at the start of a call.
struct LocalValues {
    LocalParameters values{};
    uint64_t unpredictable = 0; // one bit for each number
    UnknownValues unknown{};

    bool operator==(const LocalValues&) const = default;
};

/// A line of one of the programs that were read; source 0 is the main program.
struct ProgramLine {
    uint32_t source = 0;
    uint32_t line = 1;

    auto operator<=>(const ProgramLine&) const = default;
};

/// A macro that is called after each motion (G66) or for each block (G66.1).
struct ModalMacro {
    std::string name;
    ProgramLine begin;           // its first line
    LocalParameters arguments{}; // as left by the last call
    uint64_t unpredictable = 0;  // arguments with such values, one bit for each number
    UnknownValues unknown{};     // likewise
    int64_t rounds = 1;
    bool each_block = false; // G66.1: every block is a list of its arguments

    bool operator==(const ModalMacro&) const = default;
};

/// Lines that a statement elsewhere repeats: Siemens' REPEAT of a label up to ENDLABEL.
struct RepeatedLines {
    uint32_t first = 0, last = 0;
    uint32_t statement = 0; // line of the REPEAT, which is next after the last line

    bool operator==(const RepeatedLines&) const = default;
};

/// One call level; the first is the main program.
struct Frame {
    ProgramLine called_from; // the line of the call
    ProgramLine begin;       // the first line of what was called
    std::string name{};      // of the subprogram; empty for the main program
    LocalParameters locals{};
    bool shares_locals = false; // M98: uses #1 to #33 of the caller
    NamedValues named{};
    uint64_t unpredictable_locals = 0; // one bit for each of #1 to #33
    std::set<std::string, std::less<>> unpredictable_names{};
    UnknownValues unknown{};                                  // values of its own variables
    std::map<std::string, VariableType, std::less<>> types{}; // of declared names that are not REAL
    std::map<uint32_t, int64_t> repeats{};     // remaining repetitions, by the line of `repeat`
    std::vector<RepeatedLines> repeated{};     // being repeated, outermost first
    int64_t rounds_left = 0;                   // remaining repetitions of M98 L
    std::optional<LocalValues> again{};        // locals at the start of each repetition
    Shared<std::optional<ModalState>> saved{}; // M70, M73, SAVE
    bool restores = false;                     // M73: restore at the return
    // SAVE: what each return does with `saved` and with the state of the language at the call.
    void (*restore)(InterpreterState& state, const Frame& frame) = nullptr;
    std::shared_ptr<const LanguageState> saved_language{};
    size_t modal_macro = 0;             // the G66 that called it, counted from 1; 0 for none
    std::vector<uint32_t> known_subs{}; // main program: lines of O word subs called or passed

    bool operator==(const Frame&) const = default;
};

/// The programs of a run: the main program and the subprograms found so far. Files are only read
/// from the folders of the search path.
class ProgramLibrary {
public:
    /// The main program must outlive the library. Without a search path, subprograms are searched
    /// in the folder of the main program.
    ProgramLibrary(const Program& main, const Dialect& dialect,
                   std::vector<std::string> search_path = {});
    ~ProgramLibrary();

    const Program& program(uint32_t source) const { return *sources_[source].program; }
    const Dialect& dialect() const { return *dialect_; }
    const std::vector<std::string>& search_path() const { return search_path_; }

    /// The labels and flow statements of a program.
    ///
    /// Cost: reads all lines of the program on the first call.
    const FlowIndex& index(uint32_t source);

    /// The program in the first file of the search path with one of these names; empty when there
    /// is none.
    ///
    /// Errors: io and syntax as read_program; names that lead out of the search path.
    core::Result<std::optional<uint32_t>> find(const std::vector<std::string>& file_names);

    /// As find, but ignores case; the names are in capitals.
    core::Result<std::optional<uint32_t>>
    find_in_any_case(const std::vector<std::string>& file_names);

private:
    struct Source {
        std::shared_ptr<const Program> program;
        std::unique_ptr<FlowIndex> index;
    };

    std::vector<Source> sources_;
    std::map<std::string, uint32_t> by_path_;
    const Dialect* dialect_;
    std::vector<std::string> search_path_;
};

} // namespace gcode
