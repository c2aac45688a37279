#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "common/check.hpp"

namespace iwalk {

// What went wrong, as one line for the person at the keyboard: which file, where, what to do.
struct Error {
    std::string message;
};

// Makes an Error from a fmt format string.
template <class... Args>
Error fail(fmt::format_string<Args...> format, Args&&... args) {
    return Error{fmt::format(format, std::forward<Args>(args)...)};
}

// A value, or the Error that says why there is none. Bad data is a value here; our own bugs are a CHECK.
template <class T>
class [[nodiscard]] Result {
  public:
    Result(T value) : state_(std::move(value)) {}
    Result(Error error) : state_(std::move(error)) {}

    bool ok() const { return state_.index() == 0; }
    explicit operator bool() const { return ok(); }

    // Only when ok().
    T& value() & { return CHECK(ok()), std::get<0>(state_); }
    const T& value() const& { return CHECK(ok()), std::get<0>(state_); }
    T&& value() && { return CHECK(ok()), std::get<0>(std::move(state_)); }
    T& operator*() & { return value(); }
    const T& operator*() const& { return value(); }
    T&& operator*() && { return std::move(*this).value(); }
    T* operator->() { return &value(); }
    const T* operator->() const { return &value(); }

    // Only when not ok().
    const Error& error() const { return CHECK(!ok()), std::get<1>(state_); }

  private:
    std::variant<T, Error> state_;
};

template <>
class [[nodiscard]] Result<void> {
  public:
    Result() = default;
    Result(Error error) : error_(std::move(error)) {}

    bool ok() const { return !error_; }
    explicit operator bool() const { return ok(); }
    const Error& error() const { return CHECK(!ok()), *error_; }

  private:
    std::optional<Error> error_;
};

}  // namespace iwalk

// Leaves the enclosing function with the error, if there is one.
#define RETURN_IF_ERROR(expression)                       \
    do {                                                  \
        if (auto result_ = (expression); !result_.ok()) { \
            return result_.error();                       \
        }                                                 \
    } while (false)

// `ASSIGN_OR_RETURN(auto x, f())`: x is f's value, or the enclosing function ends with its error.
// NOLINTBEGIN(bugprone-macro-parentheses): a declaration cannot stand in parentheses
#define IWALK_JOIN2(a, b) a##b
#define IWALK_JOIN(a, b) IWALK_JOIN2(a, b)
#define ASSIGN_OR_RETURN(target, expression) \
    ASSIGN_OR_RETURN_AS(IWALK_JOIN(result_, __LINE__), target, expression)
#define ASSIGN_OR_RETURN_AS(result, target, expression) \
    auto result = (expression);                         \
    if (!result.ok()) return result.error();            \
    target = std::move(result).value()
// NOLINTEND(bugprone-macro-parentheses)
