#include "app/view/ui/system_dialog.h"

#include <utility>

#include "app/view/model/job_thread.h"

namespace app::viewer {

class SystemDialog::Thread {
public:
    explicit Thread(std::function<void()> wake)
        : jobs_(std::move(wake), [this](const DialogJob& job, uint64_t run) {
              DialogUpdate answer = ask_system(job, [&] { return jobs_.is_over(run); });
              answer.run = run;
              jobs_.deliver(std::move(answer));
          }) {}

    uint64_t start(DialogJob job) { return jobs_.start(std::move(job)); }
    DialogUpdate take() { return jobs_.take(); }

private:
    JobThread<DialogJob, DialogUpdate> jobs_;
};

SystemDialog::SystemDialog(std::function<void()> wake)
    : thread_(std::make_unique<Thread>(std::move(wake))) {}

SystemDialog::~SystemDialog() = default;

uint64_t SystemDialog::start(DialogJob job) { return thread_->start(std::move(job)); }

DialogUpdate SystemDialog::take() { return thread_->take(); }

std::optional<std::string> path_of_uri(const std::string& uri) {
    constexpr std::string_view scheme = "file://";
    if (!uri.starts_with(scheme)) return {};
    const size_t first = uri.find('/', scheme.size()); // behind the host
    if (first == std::string::npos) return {};
    const auto digit = [&](size_t at) {
        const char c = at < uri.size() ? uri[at] : ' ';
        if (c >= '0' && c <= '9') return c - '0';
        const char lower = static_cast<char>(c | 0x20);
        return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
    };
    std::string path;
    for (size_t i = first; i < uri.size(); ++i) {
        const bool is_escape = uri[i] == '%' && digit(i + 1) >= 0 && digit(i + 2) >= 0;
        path += is_escape ? static_cast<char>(16 * digit(i + 1) + digit(i + 2)) : uri[i];
        if (is_escape) i += 2;
    }
    return path.find('\0') == std::string::npos ? std::optional(path) : std::nullopt;
}

} // namespace app::viewer
