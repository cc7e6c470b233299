#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gcode/dialect.h"
#include "gcode/flow_index.h"
#include "gcode/frame.h"
#include "gcode/source.h"

namespace gcode {

/// The programs of a run: the main one, and the subprograms that were looked for so far. Files are
/// read from the folders of the search path and from nowhere else.
class ProgramLibrary {
public:
    /// The main program must stay where it is. Without a search path, the main program's own folder
    /// is searched.
    ProgramLibrary(const Program& main, const Dialect& dialect,
                   std::vector<std::string> search_path = {});

    const Program& program(uint32_t source) const { return *sources_[source].program; }
    const Dialect& dialect() const { return *dialect_; }
    const std::vector<std::string>& search_path() const { return search_path_; }

    /// The labels and flow statements of a program.
    ///
    /// Cost: reads all of its lines the first time.
    const FlowIndex& index(uint32_t source);

    /// The program in the first file of the search path that has one of these names; empty when
    /// there is none.
    ///
    /// Errors: io and syntax as read_program, and when names leave the search path.
    core::Result<std::optional<uint32_t>> find(const std::vector<std::string>& file_names);

    /// Likewise, whatever the case of the letters is; the names are in capitals.
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
