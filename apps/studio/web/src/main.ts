// Starts the page; the frame of it signs in and connects.
import "./app/app";
