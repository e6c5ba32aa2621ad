// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What refract_simulate says about its images, and the points.csv that refract_measure writes.
#ifndef REFRACT_TEST_TRUTH_FILE_HPP
#define REFRACT_TEST_TRUTH_FILE_HPP

#include <opencv2/calib3d.hpp>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

struct TrueView
{
    cv::Vec3d rvec, tvec;               //!< object -> camera 1
    std::vector<cv::Point2d> pixels;

    //! A point of the target in the frame of camera 1.
    cv::Vec3d inCamera1(const cv::Point3d& objectPoint) const
    {
        cv::Matx33d R;
        cv::Rodrigues(rvec, R);
        return R*cv::Vec3d(objectPoint) + tvec;
    }

    //! The target's plane as the tools take it: --plane=a,b,c,d
    std::string planeOption() const
    {
        cv::Matx33d R;
        cv::Rodrigues(rvec, R);
        const cv::Vec3d n(R(0, 2), R(1, 2), R(2, 2));
        return cv::format(" --plane=%.17g,%.17g,%.17g,%.17g", n[0], n[1], n[2], n.dot(tvec));
    }
};

//! By file name in the folder ("measure1/z600_1.jpg").
inline std::map<std::string, TrueView> readTruth(const std::string& folder)
{
    const cv::FileStorage fs(folder + "/truth.yml", cv::FileStorage::READ);
    std::map<std::string, TrueView> views;
    for (const cv::FileNode& node : fs["views"])
    {
        cv::Mat pixels;
        std::vector<double> rvec, tvec;
        node["pixels"] >> pixels;
        node["rvec"] >> rvec;
        node["tvec"] >> tvec;
        TrueView& view = views[(std::string)node["file"]];
        view.rvec = cv::Vec3d(rvec.data());
        view.tvec = cv::Vec3d(tvec.data());
        for (int i = 0; i < pixels.rows; i++)
            view.pixels.emplace_back(pixels.at<double>(i, 0), pixels.at<double>(i, 1));
    }
    return views;
}

inline std::vector<cv::Point3d> chessboard(int columns, int rows, double square)
{
    std::vector<cv::Point3d> points;
    for (int row = 0; row < rows; row++)
        for (int column = 0; column < columns; column++)
            points.emplace_back(square*column, square*row, 0);
    return points;
}

struct CsvRow
{
    std::string image;
    int id, status;
    cv::Point2d pixel1, pixel2;
    cv::Vec3d point, sigma;
};

//! points.csv, whose heading must be the contract's.
inline std::vector<CsvRow> readPointsCsv(const std::string& text)
{
    std::istringstream in(text);
    std::string line;
    std::getline(in, line);
    if (line != "image,id,u1,v1,u2,v2,x,y,z,sx,sy,sz,status")
        throw std::runtime_error("heading of points.csv: " + line);
    std::vector<CsvRow> rows;
    while (std::getline(in, line))
    {
        std::istringstream cells(line);
        std::string image;
        std::getline(cells, image, ',');
        std::vector<double> numbers;
        for (std::string cell; std::getline(cells, cell, ','); )
            numbers.push_back(std::stod(cell));     // takes nan
        if (numbers.size() != 12)
            throw std::runtime_error("row of points.csv: " + line);
        rows.push_back({image, (int)numbers[0], (int)numbers[11], {numbers[1], numbers[2]}, {numbers[3], numbers[4]},
                        {numbers[5], numbers[6], numbers[7]}, {numbers[8], numbers[9], numbers[10]}});
    }
    return rows;
}

#endif // REFRACT_TEST_TRUTH_FILE_HPP
