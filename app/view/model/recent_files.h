#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/setup/setup_document.h"
#include "app/view/model/file_browser.h"

namespace app::viewer {

constexpr size_t most_recent = 12;

/// The programs in the text of a list, the last one opened first; damaged entries are left out.
std::vector<RecentProgram> recent_in(const std::string& text);

/// The text of a list.
std::string text_of(const std::vector<RecentProgram>& recent);

/// The list with a program in front, each program once, at most `most_recent`.
std::vector<RecentProgram> with_recent(std::vector<RecentProgram> recent, RecentProgram opened);

/// The list of programs opened last, in a file that all windows share. Every change starts from
/// what is in the file at that moment.
class RecentFiles {
public:
    RecentFiles() = default;
    /// `file`: the list; empty: it is not kept.
    RecentFiles(std::filesystem::path file, FileWriter write);

    /// The list, the last program first.
    const std::vector<RecentProgram>& programs() const { return programs_; }

    /// Reads the list again.
    void read();
    /// Puts a program in front. Relative paths are meant from the working folder. Errors are
    /// ignored: the list is a convenience.
    void add(const std::string& program, const std::string& setup);
    /// Takes a program off the list.
    void remove(const std::string& program);

private:
    void keep() const;

    std::filesystem::path file_;
    FileWriter write_;
    std::vector<RecentProgram> programs_;
};

} // namespace app::viewer
