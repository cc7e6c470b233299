#include "app/report/skipped_group.h"

#include <algorithm>
#include <map>

namespace app {

std::vector<SkippedGroup> skipped_groups(const std::vector<SkippedFile>& skipped) {
    std::map<std::string, std::vector<std::string>> files;
    for (const SkippedFile& file : skipped) files[file.why].push_back(file.path);
    std::vector<SkippedGroup> groups;
    for (auto& [why, paths] : files) groups.push_back({why, std::move(paths)});
    std::stable_sort(groups.begin(), groups.end(),
                     [](const auto& a, const auto& b) { return a.files.size() > b.files.size(); });
    return groups;
}

} // namespace app
