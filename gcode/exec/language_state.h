#pragma once

#include <memory>

namespace gcode {

class Digest;

/// What a language stores between two blocks in addition to the modes.
class LanguageState {
public:
    virtual ~LanguageState() = default;
    virtual std::shared_ptr<LanguageState> copy() const = 0;
    virtual bool equals(const LanguageState& other) const = 0; // of the same language
    virtual void add_to(Digest& digest) const = 0;
};

/// The state of one language. Requires a function `add(Digest&, const T&)`.
template <typename T>
class StateOf final : public LanguageState {
public:
    T value;

    std::shared_ptr<LanguageState> copy() const override {
        return std::make_shared<StateOf>(*this);
    }
    bool equals(const LanguageState& other) const override {
        return value == static_cast<const StateOf&>(other).value;
    }
    void add_to(Digest& digest) const override { add(digest, value); }
};

/// The language state of a program. Copies share it until one of them is written to. Empty for
/// languages without state.
class SharedLanguageState {
public:
    SharedLanguageState() = default;
    explicit SharedLanguageState(std::shared_ptr<LanguageState> state) : state_(std::move(state)) {}

    const LanguageState* get() const { return state_.get(); }

    /// T must be the state type of the active language.
    template <typename T>
    const T& as() const {
        return static_cast<const StateOf<T>&>(*state_).value;
    }
    template <typename T>
    T& write() {
        if (state_.use_count() > 1) state_ = state_->copy();
        return static_cast<StateOf<T>&>(*state_).value;
    }

    bool is_shared_with(const SharedLanguageState& other) const { return state_ == other.state_; }

    bool operator==(const SharedLanguageState& other) const {
        return state_ == other.state_ || (state_ && other.state_ && state_->equals(*other.state_));
    }

private:
    std::shared_ptr<LanguageState> state_;
};

} // namespace gcode
