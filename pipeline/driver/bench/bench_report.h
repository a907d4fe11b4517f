#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/driver/bench/bench_run.h"

namespace patchlight {

/// Whether each measurement is on the Pareto front of CPU seconds and block error.
std::vector<bool> on_pareto_front(const std::vector<Measurement>& measurements);

/// Writes bench.csv and bench.json into bench_folder(). Missing numbers are empty in CSV and null in JSON.
/// Throws: Error (cannot_create, io_error).
void write_report(const Job& job, const CommonOptions& common, const Reference& reference,
                  const std::vector<Measurement>& measurements);

/// Throws: Error (unavailable) if gnuplot is not installed.
void check_gnuplot();

/// Writes error_against_seconds.gnuplot and runs gnuplot on it to draw the PNG. Does nothing if no measurement
/// finished. Throws: Error (cannot_create, io_error), (unavailable) if gnuplot fails.
void plot_errors(const Job& job, const std::vector<Measurement>& measurements);

/// Writes comparison.png: one row for each of at most 12 measurements, with frame, reference and false-colour error.
/// Throws: Error (missing_input, bad_data, cannot_create, io_error).
void draw_comparison(const Job& job, const Reference& reference, const std::vector<Measurement>& measurements);

}  // namespace patchlight
