#include "field_worker.h"

#include <raymap/error.h>

namespace raymap::view {

FieldWorker::FieldWorker(const Content& content, MachineOptions machine)
    : content_(content), machine_(std::move(machine)) {
  machine_.warn = {};
  machine_.progress = [this](std::string_view, double) {
    const std::lock_guard lock(mutex_);
    return !isCancelled_ && !isOver_;
  };
  thread_ = std::thread([this] { work(); });
}

FieldWorker::~FieldWorker() {
  {
    const std::lock_guard lock(mutex_);
    isOver_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void FieldWorker::ask(const FieldWish& wish) {
  {
    const std::lock_guard lock(mutex_);
    wish_ = wish;
    isCancelled_ = false;
  }
  changed_.notify_all();
}

std::optional<FieldWish> FieldWorker::wish() const {
  const std::lock_guard lock(mutex_);
  return wish_;
}

void FieldWorker::cancel() {
  const std::lock_guard lock(mutex_);
  isCancelled_ = true;
}

std::optional<MadeField> FieldWorker::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(made_, std::nullopt);
}

MadeField FieldWorker::make(const FieldWish& wish) {
  MadeField made{.wish = wish};
  try {
    Generated result =
        content_.animated
            ? generator_.generate(posed(*content_.animated, wish.seconds), wish.grid, wish.options, machine_)
            : generator_.generate(content_.mesh, wish.grid, wish.options, machine_);
    made.field = std::move(result.field);
    made.stats = std::move(result.stats);
  } catch (const std::exception& error) {
    made.error = error.what();
  }
  return made;
}

void FieldWorker::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return isOver_ || wish_; });
    if (isOver_) return;
    const FieldWish wish = *wish_;
    lock.unlock();
    MadeField made = make(wish);
    lock.lock();
    if (!isCancelled_) made_ = std::move(made);
    wish_.reset();
  }
}

}  // namespace raymap::view
