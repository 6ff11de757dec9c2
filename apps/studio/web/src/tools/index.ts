// The tools in the order of the tool bar; one line a tool, whose file registers it.
import "./navigate";
import "./stroke";
import "./rectangle";
import "./lasso";
import "./polygon";
import "./erase";
import "./copy_part";
import "./bend";
import "./lattice";
import "./combine";
import "./orient";
import "./section";
import "./fluid";

export { tools } from "./registry";
