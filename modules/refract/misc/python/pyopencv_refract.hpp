// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

// What the generated bindings call the argument types that OpenCV's own have no name for.
typedef std::vector<cv::Ptr<cv::refract::RefractiveCamera> > vector_Ptr_RefractiveCamera;
