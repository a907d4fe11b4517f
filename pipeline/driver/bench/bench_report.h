#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/driver/bench/bench_run.h"

namespace patchlight {

/// Whether each measurement is on the Pareto front of CPU seconds and block error.
std::vector<bool> on_pareto_front(const std::vector<Measurement>& measurements);

/// Writes bench.csv and bench.json into the bench's folder. Numbers that do not exist are empty, or null.
/// Throws: Error (cannot_create, io_error).
void write_report(const Job& job, const CommonOptions& common, const Reference& reference,
                  const std::vector<Measurement>& measurements);

/// Needs gnuplot. Throws: Error (unavailable) without it.
void check_gnuplot();

/// Writes error_against_seconds.gnuplot and has gnuplot make the PNG of it; nothing without a finished measurement.
/// Throws: Error (cannot_create, io_error), (unavailable) if gnuplot fails.
void plot_errors(const Job& job, const std::vector<Measurement>& measurements);

/// Writes comparison.png: a row for each measurement, at most 12, of its frame, the reference and the error as colours.
/// Throws: Error (missing_input, bad_data, cannot_create, io_error).
void draw_comparison(const Job& job, const Reference& reference, const std::vector<Measurement>& measurements);

}  // namespace patchlight
