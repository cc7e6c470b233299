/// Checks one program against a set-up and prints the report as JSON: the smallest program that
/// uses Feeler as a library. check_only.sh verifies that it needs neither a window nor a database.
#include <cstdio>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/report/json/json_report.h"

int main(int argc, char** argv) {
    if (argc != 3) return 2;
    app::CheckJob job;
    job.program = argv[1];
    job.setup = argv[2];
    const auto run = app::run_check(job);
    if (!run) {
        std::fprintf(stderr, "%s\n", run.error().message.c_str());
        return 2;
    }
    std::fputs(app::json_report(*run, false).c_str(), stdout);
    return run->has_errors() ? 1 : 0;
}
