// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Options(flags, field=value, ...): C++ has a constructor of the flags alone, of results one of nothing.
#pragma once

template<typename Fields> static PyObject* makeOfFields(PyTypeObject* type, PyObject* args, PyObject* keywords)
{
    PySafeObject self(pyopencv_from(Fields()));
    PyObject* flags = NULL;
    if (!self || !PyArg_ParseTuple(args, "|O", &flags))
        return blame(nameOf(type).c_str()), nullptr;
    if (flags && keywords && PyDict_GetItemString(keywords, "flags"))
        return raise(nameOf(type) + ": flags is given twice"), nullptr;
    if (flags && PyObject_SetAttrString(self, "flags", flags) != 0)
        return blame(nameOf(type).c_str()), nullptr;
    PyObject *name, *value;
    for (Py_ssize_t next = 0; keywords && PyDict_Next(keywords, &next, &name, &value);)
    {
        if (!PyObject_HasAttr(self, name))
            return raise(nameOf(type) + ": there is no field " + textOf(name)), nullptr;
        if (PyObject_SetAttr(self, name, value) != 0)
            return blame(nameOf(type).c_str()), nullptr;
    }
    return self.release();
}

template<> newfunc makerOf<&pyopencv_cv_refract_refract_GlassRigOptions_GlassRigOptions>()
{
    return makeOfFields<refract::GlassRigOptions>;
}

template<> newfunc makerOf<&pyopencv_cv_refract_refract_GlassRigResult_GlassRigResult>()
{
    return makeOfFields<refract::GlassRigResult>;
}

template<> newfunc makerOf<&pyopencv_cv_refract_refract_BundleAdjustOptions_BundleAdjustOptions>()
{
    return makeOfFields<refract::BundleAdjustOptions>;
}

template<> newfunc makerOf<&pyopencv_cv_refract_refract_BundleAdjustResult_BundleAdjustResult>()
{
    return makeOfFields<refract::BundleAdjustResult>;
}
