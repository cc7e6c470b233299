#pragma once

#include <string>

#include "app/batch/batch_result.h"

namespace app {

/// The folder that the paths of all programs begin with, with its slash; empty if there is none.
std::string common_folder(const BatchResult& batch);

/// "125 programs in parts/".
std::string batch_title(const BatchResult& batch);

/// What became of a batch, in some words: "3 of 125 programs were not checked to their end".
std::string batch_outcome_text(const BatchResult& batch);

/// The class by which the page colours that.
const char* batch_outcome_class(const BatchResult& batch);

/// What is missing, before anything else is said: programs that were not checked, or not to their
/// end. As HTML; empty when all is there.
std::string html_missing(const BatchResult& batch);

/// A button for each outcome that some program has, with their number, as HTML.
std::string html_outcomes(const BatchResult& batch);

/// What is said of a batch as a whole, as rows of an HTML table.
std::string html_batch_summary(const BatchResult& batch);

/// The rules that were found, as rows of an HTML table, each with a button.
std::string html_rules(const BatchResult& batch);

/// The files that were skipped, by the reason, as HTML.
std::string html_skipped(const BatchResult& batch);

} // namespace app
