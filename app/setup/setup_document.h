#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace app {

/// The text of a set-up while a person edits it, with undo and redo.
///
/// The text is the set-up: what is on screen is read from it, and it is what is saved.
class SetupDocument {
public:
    /// Gives the new text, or the reason why there is none.
    using Edit = std::function<core::Result<std::string>(const std::string&)>;

    SetupDocument() = default;
    /// `path`: of the file that holds the text; empty: none yet.
    SetupDocument(std::string path, std::string text);

    const std::string& path() const { return path_; }
    const std::string& text() const { return text_; }
    /// The text in the file.
    const std::string& saved_text() const { return saved_; }
    bool is_modified() const { return text_ != saved_; }
    /// Changes whenever the text does.
    uint64_t version() const { return version_; }

    /// Edits the text. `title` names the edit in the list of what can be undone. Successive edits
    /// with the same mark, such as those of one drag, are undone together; an empty mark stands
    /// alone.
    ///
    /// Errors: those of the edit. The text is then unchanged.
    core::Result<void> edit(const std::string& title, const Edit& edit,
                            const std::string& mark = {});
    /// Ends a sequence of edits with the same mark.
    void end_sequence() { mark_.clear(); }

    /// The title of the edit that undo() takes back, or redo() makes again; empty: there is none.
    std::string undo_title() const { return undo_.empty() ? std::string() : undo_.back().title; }
    std::string redo_title() const { return redo_.empty() ? std::string() : redo_.back().title; }
    void undo();
    void redo();

    /// The text has been written to a file.
    void saved_as(std::string path);
    /// The file has changed: `text` is in it now. The old text can be had by undo().
    void file_changed(std::string text);
    /// Keeps the text although the file has changed; it then counts as modified.
    void keep_over(std::string text_of_file) { saved_ = std::move(text_of_file); }
    /// Whether undo() has taken back what another program wrote into the file, so that saving would
    /// overwrite it.
    bool takes_back_file() const { return changes_taken_back_ > 0; }

private:
    struct Version {
        std::string title, text; // `text`: on the other side of the edit
        bool is_of_file = false; // another program has made it
    };
    void put(std::string text);

    std::string path_, text_, saved_, mark_;
    std::vector<Version> undo_, redo_;
    uint64_t version_ = 0;
    int changes_taken_back_ = 0; // of the file by another program, by undo()
};

/// Writes a file completely or not at all.
using FileWriter =
    std::function<core::Result<void>(const std::string& path, const std::string& text)>;

/// What may happen to a file that is there already.
enum class Replacing : uint8_t { refused, allowed };

/// Saves the text of a set-up.
///
/// `program`: the program that is checked, which is never overwritten.
/// Errors: those of `write`; invalid_value for another existing file unless it may be replaced, for
///         the file of the document if its content has changed since it was read, for the program,
///         and for a folder in which relative paths of the set-up would be invalid.
core::Result<void> save_setup(SetupDocument& document, const std::string& path, Replacing replacing,
                              const std::string& program, const FileWriter& write);

/// Whether a set-up names files by paths relative to its folder.
bool names_relative_files(const std::string& text);

/// The text of a set-up with the relative paths of files made whole, so that it can be saved in
/// another folder.
///
/// `folder`: of the set-up, absolute.
/// Errors: those of toml_with_value.
core::Result<std::string> with_whole_paths(const std::string& text, const std::string& folder);

} // namespace app
