#include "app/viewer/session_worker.h"

#include <utility>

namespace app::viewer {

SessionWorker::SessionWorker(std::function<void()> wake)
    : wake_(std::move(wake)), thread_([this] { run(); }) {}

SessionWorker::~SessionWorker() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void SessionWorker::post(Task task) {
    {
        const std::lock_guard lock(mutex_);
        tasks_.push_back(std::move(task));
    }
    changed_.notify_all();
}

void SessionWorker::open(const CheckJob& job) {
    interrupt();
    post([this, job](WorkerSession& session) {
        const auto publish = [&] { deliver(session.take_news()); };
        session.open(job, publish);
    });
}

void SessionWorker::show(const ShowRequest& request) {
    {
        const std::lock_guard lock(mutex_);
        wanted_ = request;
    }
    changed_.notify_all();
}

uint64_t SessionWorker::walk(Walk walk, size_t block) {
    const uint64_t number = ++walks_;
    post([this, number, walk, block](WorkerSession& session) {
        walking_ = number;
        session.walk(walk, block, number);
    });
    return number;
}

void SessionWorker::set_breakpoints(const std::vector<Breakpoint>& breakpoints) {
    post([breakpoints](WorkerSession& session) { session.set_breakpoints(breakpoints); });
}

void SessionWorker::watch(const std::vector<std::string>& expressions) {
    post([expressions](WorkerSession& session) { session.watch(expressions); });
}

void SessionWorker::change(const WhatIf& change, size_t block) {
    post([change, block](WorkerSession& session) { session.change(change, block); });
}

void SessionWorker::take_back() {
    post([](WorkerSession& session) { session.take_back(); });
}

void SessionWorker::save_setup(const SaveRequest& request) {
    post([request](WorkerSession& session) { session.save_setup(request); });
}

SessionUpdate SessionWorker::take() {
    const std::lock_guard lock(mutex_);
    SessionUpdate news = std::move(news_);
    news_ = {};
    return news;
}

void SessionWorker::deliver(SessionUpdate news) {
    if (!news.has_news) return;
    {
        const std::lock_guard lock(mutex_);
        merge(news_, std::move(news));
    }
    wake_();
}

std::optional<ShowRequest> SessionWorker::wanted(const WorkerSession& session) {
    const std::lock_guard lock(mutex_);
    if (!wanted_ || !session.can_show(*wanted_)) return {};
    return std::exchange(wanted_, std::nullopt);
}

void SessionWorker::run() {
    const auto is_interrupted = [this] {
        return stopping_ || (walking_ != 0 && walking_ <= interrupted_);
    };
    WorkerSession session(is_interrupted, [this] { return stopping_.load(); });
    while (!stopping_) {
        Task task;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&] {
                return stopping_ || !tasks_.empty() || session.has_work()
                       || (wanted_ && session.can_show(*wanted_));
            });
            if (!tasks_.empty()) {
                task = std::move(tasks_.front());
                tasks_.pop_front();
            }
        }
        if (stopping_) return;
        if (task) {
            task(session);
        } else if (const auto request = wanted(session)) {
            session.show(*request);
        } else {
            session.record();
        }
        deliver(session.take_news());
    }
}

} // namespace app::viewer
