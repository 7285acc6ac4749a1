#pragma once

#include <raymap/generate.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "content.h"

namespace raymap::view {

/// A field that is wanted.
struct FieldWish {
  Grid grid = {};
  FieldOptions options = {};
  double seconds = 0.0;  ///< Time of the pose.
  bool operator==(const FieldWish&) const = default;
};

/// A field that was made, or why it was not.
struct MadeField {
  FieldWish wish = {};
  Field field = {};
  Stats stats = {};
  std::string error = {};
};

/// A thread that makes fields on the CPU.
class FieldWorker {
 public:
  /// All of `machine` but its callbacks is used. The content must outlive the worker.
  FieldWorker(const Content& content, MachineOptions machine);
  ~FieldWorker();
  FieldWorker(const FieldWorker&) = delete;
  FieldWorker& operator=(const FieldWorker&) = delete;

  /// Asks for a field. Only while `wish` returns nothing.
  void ask(const FieldWish& wish);
  /// Returns the field that it makes now.
  std::optional<FieldWish> wish() const;
  /// Stops making a field.
  void cancel();
  /// Returns the field that it made last, once. A cancelled one is never returned.
  std::optional<MadeField> take();

 private:
  void work();
  MadeField make(const FieldWish& wish);

  const Content& content_;
  MachineOptions machine_;
  Generator generator_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<FieldWish> wish_;
  std::optional<MadeField> made_;
  bool isCancelled_ = false, isOver_ = false;
  std::thread thread_;
};

}  // namespace raymap::view
